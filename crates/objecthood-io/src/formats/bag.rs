//! ROS 1 bags, version 2.0, among them those of RealSense.
//!
//! A file is a row of records, each a header of named fields and data. Messages stand in chunks, which may be packed; behind a
//! chunk stand lists of its messages, with their times. The file is listed by these, front to back.
//!
//! Source: the ROS wiki, *Bags/Format/2.0*.

use std::collections::BTreeMap;

use super::{Format, RecordingFormat};
use crate::recording::{
    Bytes, Channel, Chunked, Fields, Listing, Log, Packed, Problem, RecordingError, Records, Window, Wire,
    each_record, place_in, read,
};

pub(super) const FORMAT: Format =
    Format::Recording(RecordingFormat { extensions: &["bag"], is_mine: |head| head.starts_with(MAGIC), log });

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
const NAME: &str = "ROS 1";

/// What a record is.
mod op {
    pub(super) const MESSAGE: u8 = 0x02;
    pub(super) const INDEX: u8 = 0x04;
    pub(super) const CHUNK: u8 = 0x05;
    pub(super) const CONNECTION: u8 = 0x07;
}

/// The most bytes of a header, and of the data of a connection: it has the definition of its type.
const MAX_HEADER: u64 = 1 << 20;
/// Bytes of a message in a list: its time and its place.
const LIST_ENTRY: u64 = 12;
/// The most bytes of a list of messages.
const MAX_LIST: u64 = 16 << 20;

fn log(bytes: Box<dyn Bytes>) -> Result<Log, RecordingError> {
    let mut scan = Scan::default();
    let cut_at = scan.file(&*bytes)?;
    Ok(scan.listing.finish(cut_at, Box::new(Chunked::<Record>::new(bytes))))
}

/// The head of a record.
struct Record {
    header: Vec<u8>,
    /// Where its data begin and end.
    at: u64,
    end: u64,
}

impl Record {
    /// The field of this name; none is empty.
    fn field(&self, name: &[u8]) -> &[u8] {
        let fields = &mut Fields::packed(&self.header);
        while let Ok(field) = fields.bytes() {
            if let Some(value) = field.strip_prefix(name).and_then(|rest| rest.strip_prefix(b"=")) {
                return value;
            }
        }
        &[]
    }

    fn op(&self) -> Option<u8> {
        self.field(b"op").first().copied()
    }

    fn number(&self, name: &[u8]) -> Result<u32, RecordingError> {
        let missing = |_: Problem| damaged(self.at, "a record lacks a number");
        Fields::packed(self.field(name)).u32().map_err(missing)
    }
}

impl Records for Record {
    const NAME: &'static str = NAME;

    fn read(window: &mut Window<'_>, at: u64, len: u64) -> Result<Option<Self>, RecordingError> {
        let size =
            |bytes: Option<&[u8]>| bytes.and_then(|bytes| Fields::packed(bytes).u32().ok()).map(u64::from);
        let Some(header_size) = size(window.get(at, 4)?) else { return Ok(None) };
        if header_size > MAX_HEADER {
            return Err(damaged(at, "a record has a header of more than 1 MB"));
        }
        let Some(header) = window.get(at + 4, header_size as usize)?.map(<[u8]>::to_vec) else {
            return Ok(None);
        };
        let Some(data_size) = size(window.get(at + 4 + header_size, 4)?) else { return Ok(None) };
        let at = at + 8 + header_size;
        Ok((at + data_size <= len).then_some(Self { header, at, end: at + data_size }))
    }

    fn end(&self) -> u64 {
        self.end
    }

    fn packed(&self, _: &dyn Bytes) -> Result<Packed, RecordingError> {
        Ok(Packed {
            compression: self.field(b"compression").to_vec(),
            at: self.at,
            packed: self.end - self.at,
            unpacked: self.number(b"size")?.into(),
        })
    }

    fn message(bytes: &dyn Bytes, at: u64) -> Result<Vec<u8>, RecordingError> {
        match Self::read(&mut Window::new(bytes), at, bytes.len())? {
            Some(record) if record.op() == Some(op::MESSAGE) => {
                read(bytes, record.at, record.end - record.at)
            }
            _ => Err(damaged(at, "no message is where its list says")),
        }
    }
}

/// What was listed so far.
#[derive(Default)]
struct Scan {
    /// Places in the list of channels by the numbers of the file.
    numbers: BTreeMap<u32, usize>,
    listing: Listing,
}

impl Scan {
    /// Lists the records of the file. Returns where they end too early, if they do.
    fn file(&mut self, bytes: &dyn Bytes) -> Result<Option<u64>, RecordingError> {
        let mut window = Window::new(bytes);
        let mut at = MAGIC.len() as u64;
        let mut chunk = None;
        while at < bytes.len() {
            let Some(record) = Record::read(&mut window, at, bytes.len())? else { return Ok(Some(at)) };
            match record.op() {
                Some(op::CHUNK) => {
                    let packed = record.packed(bytes)?;
                    let next = Record::read(&mut window, record.end, bytes.len())?;
                    if next.is_none_or(|next| next.op() != Some(op::INDEX)) {
                        self.chunk(bytes, at, &packed)?;
                    }
                    chunk = Some((at, packed));
                }
                Some(op::INDEX) => {
                    let (at, packed) =
                        chunk.as_ref().ok_or_else(|| damaged(at, "a list of messages has no chunk"))?;
                    self.list(bytes, &record, *at, packed)?;
                }
                Some(op::CONNECTION) => self.connect(bytes, &record)?,
                _ => {}
            }
            at = record.end;
        }
        Ok(None)
    }

    /// Lists the records of a chunk that has no lists of its messages.
    fn chunk(&mut self, bytes: &dyn Bytes, at: u64, packed: &Packed) -> Result<(), RecordingError> {
        each_record(packed, bytes, |content, record: &Record, inside| match record.op() {
            Some(op::CONNECTION) => self.connect(content, record),
            Some(op::MESSAGE) => {
                let time_ns = time_ns(record.field(b"time"));
                let time_ns = time_ns.map_err(|_| damaged(at, "a message has no time"))?;
                if let Some(&channel) = self.numbers.get(&record.number(b"conn")?) {
                    self.listing.message(channel, time_ns, place_in(at, packed, inside));
                }
                Ok(())
            }
            _ => Ok(()),
        })
    }

    /// Takes a connection. The first one of a number holds.
    fn connect(&mut self, bytes: &dyn Bytes, record: &Record) -> Result<(), RecordingError> {
        let number = record.number(b"conn")?;
        if self.numbers.contains_key(&number) {
            return Ok(());
        }
        if record.end - record.at > MAX_HEADER {
            return Err(damaged(record.at, "a connection of more than 1 MB"));
        }
        let header = read(bytes, record.at, record.end - record.at)?;
        let inner = Record { header, at: record.at, end: record.end };
        let channel = Channel::new(record.field(b"topic"), inner.field(b"type"), Wire::Ros1);
        self.numbers.insert(number, self.listing.channel(channel));
        Ok(())
    }

    /// Takes the list of a chunk's messages of one connection.
    fn list(
        &mut self,
        bytes: &dyn Bytes,
        record: &Record,
        at: u64,
        packed: &Packed,
    ) -> Result<(), RecordingError> {
        let number = record.number(b"conn")?;
        if record.end - record.at > MAX_LIST {
            return Err(damaged(record.at, "a list of more than a million messages"));
        }
        if !self.numbers.contains_key(&number) {
            // The connections stand in the chunk.
            each_record(packed, bytes, |content, record: &Record, _| match record.op() {
                Some(op::CONNECTION) => self.connect(content, record),
                _ => Ok(()),
            })?;
        }
        let Some(&channel) = self.numbers.get(&number) else { return Ok(()) };
        if !self.listing.is_read(channel) {
            self.listing.count(channel, (record.end - record.at) / LIST_ENTRY);
            return Ok(());
        }
        let content = read(bytes, record.at, record.end - record.at)?;
        for entry in content.chunks_exact(LIST_ENTRY as usize) {
            let (time, inside) = entry.split_at(8);
            let wrong = |_: Problem| damaged(record.at, "a list of messages is too short");
            let (time_ns, inside) =
                (time_ns(time).map_err(wrong)?, Fields::packed(inside).u32().map_err(wrong)?);
            self.listing.message(channel, time_ns, place_in(at, packed, inside.into()));
        }
        Ok(())
    }
}

/// Seconds and nanoseconds.
fn time_ns(field: &[u8]) -> Result<i64, Problem> {
    let fields = &mut Fields::packed(field);
    Ok(i64::from(fields.u32()?) * 1_000_000_000 + i64::from(fields.u32()?))
}

fn damaged(at: u64, problem: &str) -> RecordingError {
    RecordingError::Damaged { format: NAME, at, problem: problem.to_owned() }
}
