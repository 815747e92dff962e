//! Tables of an `SQLite` file, read only.
//!
//! A table is a tree of pages. A leaf has cells, each a row: how long it is, its number, its values, of which those that do not
//! fit go on in a chain of other pages. Values begin with a list of their types. Source: *Database File Format*, sqlite.org.

use crate::recording::{Bytes, Place, RecordingError, read};

pub(super) const MAGIC: &[u8] = b"SQLite format 3\0";

/// Levels of a tree: with two cells a page there are more rows than bytes in any file.
const MAX_DEPTH: usize = 40;

/// The most bytes of a row: that of `SQLite` itself is a billion, and no message of a frame is as large.
const MAX_ROW: u64 = 256 << 20;

/// A file whose pages are read when they are needed.
pub(super) struct Database {
    bytes: Box<dyn Bytes>,
    page_size: u64,
    /// Bytes of a page that are used.
    usable: u64,
}

/// A value of a row.
pub(super) enum Value {
    Whole(i64),
    Bytes(Vec<u8>),
    /// Nothing, or a number that is not whole.
    Other,
}

/// A row, of which the part on its own page is there.
pub(super) struct Row<'a> {
    pub(super) id: i64,
    pub(super) place: Place,
    cell: Cell<'a>,
}

/// The part of a row that lies on its own page.
struct Cell<'a> {
    id: i64,
    /// Bytes of the whole row.
    size: u64,
    local: &'a [u8],
    /// The page on which it goes on; 0 = none.
    next_page: u32,
}

impl Row<'_> {
    /// The first values, as far as they lie on the row's own page.
    pub(super) fn values<const COUNT: usize>(&self) -> Result<[Value; COUNT], RecordingError> {
        // The columns that are asked for come first and are short, so they lie on the row's own page.
        let content = self.cell.local;
        let columns = columns(content).ok_or_else(|| damaged(0, "a row has no list of its values"))?;
        let value = |column: usize| -> Value {
            let Some(&(kind, at)) = columns.get(column) else { return Value::Other };
            let Some(bytes) = content.get(at..).and_then(|rest| rest.get(..size_of_kind(kind))) else {
                return Value::Other;
            };
            match kind {
                1..=6 => Value::Whole(whole(bytes)),
                8 => Value::Whole(0),
                9 => Value::Whole(1),
                12.. => Value::Bytes(bytes.to_vec()),
                _ => Value::Other,
            }
        };
        Ok(std::array::from_fn(value))
    }
}

impl Database {
    pub(super) fn open(bytes: Box<dyn Bytes>) -> Result<Self, RecordingError> {
        let head = read(&*bytes, 0, 100)?;
        let page_size = match u64::from(u16::from_be_bytes([head[16], head[17]])) {
            1 => 65_536,
            size => size,
        };
        let usable = page_size.saturating_sub(head[20].into());
        if !page_size.is_power_of_two() || page_size < 512 || usable < 480 {
            return Err(damaged(16, "no page has such a size"));
        }
        Ok(Self { bytes, page_size, usable })
    }

    /// Visits the rows of a table in their order.
    pub(super) fn rows(
        &self,
        table: &str,
        mut visit: impl FnMut(&Row<'_>) -> Result<(), RecordingError>,
    ) -> Result<(), RecordingError> {
        let mut root = None;
        self.walk(1, 0, &mut self.pages(), &mut |row| {
            if let [_, Value::Bytes(name), _, Value::Whole(page)] = row.values()?
                && name == table.as_bytes()
            {
                root = u32::try_from(page).ok();
            }
            Ok(())
        })?;
        let root =
            root.ok_or_else(|| damaged(0, &format!("it has no table `{table}`: it is not a ROS 2 bag")))?;
        self.walk(root, 0, &mut self.pages(), &mut visit)
    }

    /// Pages of the file.
    fn pages(&self) -> u64 {
        self.bytes.len() / self.page_size
    }

    /// Visits the rows below a page. `pages_left` bounds the way through a tree that leads in circles.
    fn walk(
        &self,
        page: u32,
        depth: usize,
        pages_left: &mut u64,
        visit: &mut dyn FnMut(&Row<'_>) -> Result<(), RecordingError>,
    ) -> Result<(), RecordingError> {
        let left = pages_left.checked_sub(1).filter(|_| depth <= MAX_DEPTH);
        *pages_left = left.ok_or_else(|| damaged(0, "its pages lead in circles"))?;
        let (content, head) = self.page(page)?;
        let wrong = |problem: &str| damaged(u64::from(page) * self.page_size, problem);
        let kind = content[head];
        let cells = usize::from(u16::from_be_bytes([content[head + 3], content[head + 4]]));
        let first = head + if kind == INTERIOR { 12 } else { 8 };
        let places =
            content.get(first..first + 2 * cells).ok_or_else(|| wrong("a page has too many cells"))?;
        for (number, place) in places.chunks_exact(2).enumerate() {
            let at = usize::from(u16::from_be_bytes([place[0], place[1]]));
            if kind == LEAF {
                let cell = self.cell(&content, at).ok_or_else(|| wrong("a row is cut off"))?;
                let place = Place(page.into(), number as u64);
                visit(&Row { id: cell.id, place, cell })?;
            } else {
                let child = page_number(&content, at).ok_or_else(|| wrong("a page leads nowhere"))?;
                self.walk(child, depth + 1, pages_left, visit)?;
            }
        }
        if kind == INTERIOR {
            let last = page_number(&content, head + 8).ok_or_else(|| wrong("a page leads nowhere"))?;
            self.walk(last, depth + 1, pages_left, visit)?;
        }
        Ok(())
    }

    /// A page of a table, and where its head begins.
    fn page(&self, page: u32) -> Result<(Vec<u8>, usize), RecordingError> {
        let at = u64::from(page).checked_sub(1).ok_or_else(|| damaged(0, "a page has the number 0"))?;
        let content = read(&*self.bytes, at * self.page_size, self.page_size)?;
        let head = if page == 1 { 100 } else { 0 };
        match content[head] {
            LEAF | INTERIOR => Ok((content, head)),
            _ => Err(damaged(at * self.page_size, "a page is none of a table")),
        }
    }

    fn cell<'a>(&self, page: &'a [u8], at: usize) -> Option<Cell<'a>> {
        let mut rest = page.get(at..)?;
        let size = variable(&mut rest)?;
        let id = variable(&mut rest)?.cast_signed();
        let local = self.local(size);
        let next_page = if local < size { page_number(rest, local as usize)? } else { 0 };
        Some(Cell { id, size, local: rest.get(..local as usize)?, next_page })
    }

    /// How many bytes of a row lie on its own page.
    fn local(&self, size: u64) -> u64 {
        let most = self.usable - 35;
        if size <= most {
            return size;
        }
        let least = (self.usable - 12) * 32 / 255 - 23;
        let even = least + (size - least) % (self.usable - 4);
        if even <= most { even } else { least }
    }

    /// The bytes of a row.
    fn content(&self, cell: &Cell<'_>) -> Result<Vec<u8>, RecordingError> {
        if cell.size > MAX_ROW {
            return Err(RecordingError::TooLarge { bytes: cell.size, most: MAX_ROW });
        }
        let mut content = cell.local.to_vec();
        let mut page = cell.next_page;
        while (content.len() as u64) < cell.size {
            let at = u64::from(page).checked_sub(1).ok_or_else(|| damaged(0, "a row ends too early"))?;
            let count = (cell.size - content.len() as u64).min(self.usable - 4);
            let part = read(&*self.bytes, at * self.page_size, 4 + count)?;
            page = page_number(&part, 0).unwrap_or(0);
            content.extend_from_slice(&part[4..]);
            if content.len() as u64 > self.bytes.len() {
                return Err(damaged(0, "a row is longer than the file"));
            }
        }
        Ok(content)
    }

    /// The bytes of a column of the row at a place.
    pub(super) fn column(&self, place: Place, column: usize) -> Result<Vec<u8>, RecordingError> {
        let wrong = || damaged(place.0 * self.page_size, "a row is not where it was");
        let (page, head) = self.page(u32::try_from(place.0).map_err(|_| wrong())?)?;
        let cell_at = (page[head] == LEAF).then(|| head + 8 + 2 * place.1 as usize);
        let at = cell_at.and_then(|at| page.get(at..at + 2)).ok_or_else(wrong)?;
        let cell = self.cell(&page, usize::from(u16::from_be_bytes([at[0], at[1]]))).ok_or_else(wrong)?;
        let mut content = self.content(&cell)?;
        let (kind, at) =
            columns(&content).and_then(|columns| columns.get(column).copied()).ok_or_else(wrong)?;
        let size = size_of_kind(kind);
        let end = at.checked_add(size).filter(|&end| kind >= 12 && end <= content.len()).ok_or_else(wrong)?;
        content.truncate(end);
        content.drain(..at);
        Ok(content)
    }
}

/// Kinds of pages of a table.
const LEAF: u8 = 13;
const INTERIOR: u8 = 5;

fn page_number(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|&page| u32::from_be_bytes(page))
}

/// A number of one to nine bytes, seven bits each, the highest first; the ninth has eight.
fn variable(rest: &mut &[u8]) -> Option<u64> {
    let mut number = 0_u64;
    for place in 0..9 {
        let (&byte, others) = rest.split_first()?;
        *rest = others;
        if place == 8 {
            return Some(number << 8 | u64::from(byte));
        }
        number = number << 7 | u64::from(byte & 127);
        if byte & 128 == 0 {
            break;
        }
    }
    Some(number)
}

/// A big-endian number with a sign, of up to eight bytes.
fn whole(bytes: &[u8]) -> i64 {
    let sign = if bytes.first().is_some_and(|&byte| byte >= 128) { -1 } else { 0 };
    bytes.iter().fold(sign, |number, &byte| number << 8 | i64::from(byte))
}

fn size_of_kind(kind: u64) -> usize {
    match kind {
        0 | 8..=11 => 0,
        1..=4 => kind as usize,
        5 => 6,
        6 | 7 => 8,
        _ => usize::try_from((kind - 12) / 2).unwrap_or(usize::MAX),
    }
}

/// The type of every value of a row, and where it begins.
fn columns(content: &[u8]) -> Option<Vec<(u64, usize)>> {
    let mut rest = content;
    let head_size = usize::try_from(variable(&mut rest)?).ok()?;
    let mut head = content.get(content.len() - rest.len()..head_size)?;
    let (mut at, mut columns) = (head_size, Vec::new());
    while !head.is_empty() {
        let kind = variable(&mut head)?;
        columns.push((kind, at));
        at = at.checked_add(size_of_kind(kind))?;
    }
    Some(columns)
}

fn damaged(at: u64, problem: &str) -> RecordingError {
    RecordingError::Damaged { format: "SQLite", at, problem: problem.to_owned() }
}
