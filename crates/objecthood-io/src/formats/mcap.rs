//! MCAP recordings of ROS 1 and ROS 2.
//!
//! A file is a row of records: a byte that says what it is, the number of bytes behind, the bytes. Messages stand among them,
//! or in chunks, which may be packed; behind a chunk stand lists of its messages, with their times. So the file is listed
//! by its heads and lists alone, front to back, whether it has a summary or ends in the middle, and any message is read by itself.
//!
//! Source: the MCAP format specification, version 0.

use std::collections::BTreeMap;

use super::{Format, RecordingFormat};
use crate::recording::{
    Bytes, Channel, Chunked, Fields, Listing, Log, Packed, Place, Problem, RecordingError, Records, Window,
    Wire, each_record, place_in, read,
};

pub(super) const FORMAT: Format = Format::Recording(RecordingFormat {
    extensions: &["mcap"],
    is_mine: |head| head.starts_with(MAGIC),
    log,
});

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
const NAME: &str = "MCAP";

/// What a record is.
mod op {
    pub(super) const FOOTER: u8 = 0x02;
    pub(super) const SCHEMA: u8 = 0x03;
    pub(super) const CHANNEL: u8 = 0x04;
    pub(super) const MESSAGE: u8 = 0x05;
    pub(super) const CHUNK: u8 = 0x06;
    pub(super) const MESSAGE_INDEX: u8 = 0x07;
    pub(super) const DATA_END: u8 = 0x0f;
}

/// Bytes of a record before its content, and of a message before its data.
const RECORD_HEAD: u64 = 9;
const MESSAGE_HEAD: u64 = 22;
/// Bytes of a list of messages before the first, and of each: its time and its place.
const LIST_HEAD: u64 = 6;
const LIST_ENTRY: u64 = 16;
/// Bytes before the name of a chunk's compression.
const CHUNK_HEAD: u64 = 28;

/// The most bytes of a schema, a channel or a list of messages. Lists take 16 bytes a message.
const MAX_SMALL: u64 = 16 << 20;

fn log(bytes: Box<dyn Bytes>) -> Result<Log, RecordingError> {
    let mut scan = Scan::default();
    let cut_at = scan.file(&*bytes)?;
    Ok(scan.listing.finish(cut_at, Box::new(Chunked::<Record>::new(bytes))))
}

/// The head of a record.
struct Record {
    op: u8,
    /// Where its content begins and ends.
    at: u64,
    end: u64,
}

impl Records for Record {
    const NAME: &'static str = NAME;

    fn read(window: &mut Window<'_>, at: u64, len: u64) -> Result<Option<Self>, RecordingError> {
        let Some(head) = window.get(at, RECORD_HEAD as usize)? else { return Ok(None) };
        let count = head[1..].iter().rev().fold(0, |count, &byte| count << 8 | u64::from(byte));
        let (op, at) = (head[0], at + RECORD_HEAD);
        Ok(at.checked_add(count).filter(|&end| end <= len).map(|end| Self { op, at, end }))
    }

    fn end(&self) -> u64 {
        self.end
    }

    fn packed(&self, bytes: &dyn Bytes) -> Result<Packed, RecordingError> {
        // The name of a compression has a few letters.
        let count = (self.end - self.at).min(CHUNK_HEAD + 64);
        let head = read(bytes, self.at, count)?;
        let parse = || {
            let fields = &mut Fields::packed(&head);
            fields.raw(16)?;
            let unpacked = fields.u64()?;
            fields.u32()?;
            let compression = fields.text()?.to_vec();
            Ok::<_, Problem>((unpacked, compression, fields.u64()?, fields.taken() as u64))
        };
        let (unpacked, compression, packed, taken) = parse().map_err(|problem| damaged(self.at, &problem))?;
        let at = self.at + taken;
        if at.checked_add(packed).is_none_or(|end| end > self.end) {
            return Err(damaged(self.at, "its chunk is longer than its record"));
        }
        Ok(Packed { compression, at, packed, unpacked })
    }

    fn message(bytes: &dyn Bytes, at: u64) -> Result<Vec<u8>, RecordingError> {
        let head = read(bytes, at, RECORD_HEAD)?;
        let record = Self::read(&mut Window::new(&head), 0, u64::MAX)?;
        let Some(Self { op: op::MESSAGE, end, .. }) = record else {
            return Err(damaged(at, "no message is where its list says"));
        };
        let count = (end - RECORD_HEAD).checked_sub(MESSAGE_HEAD);
        let count = count.ok_or_else(|| damaged(at, "a message without a head"))?;
        read(bytes, at.saturating_add(RECORD_HEAD + MESSAGE_HEAD), count)
    }
}

/// What was listed so far.
#[derive(Default)]
struct Scan {
    /// Names of types by their numbers.
    schemas: BTreeMap<u16, Vec<u8>>,
    /// Places in the list of channels by the numbers of the file.
    numbers: BTreeMap<u16, usize>,
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
            match record.op {
                op::FOOTER | op::DATA_END => return Ok(None),
                op::CHUNK => {
                    let packed = record.packed(bytes)?;
                    let next = window.get(record.end, 1)?.map(|op| op[0]);
                    if next != Some(op::MESSAGE_INDEX) {
                        self.chunk(bytes, at, &packed)?;
                    }
                    chunk = Some((at, packed));
                }
                op::MESSAGE_INDEX => {
                    let (at, packed) =
                        chunk.as_ref().ok_or_else(|| damaged(at, "a list of messages has no chunk"))?;
                    self.list(bytes, &record, *at, packed)?;
                }
                _ => self.record(bytes, &record, Place(0, at))?,
            }
            at = record.end;
        }
        Ok(Some(at))
    }

    /// Lists the records of a chunk that has no lists of its messages.
    fn chunk(&mut self, bytes: &dyn Bytes, at: u64, packed: &Packed) -> Result<(), RecordingError> {
        each_record(packed, bytes, |content, record, inside| {
            self.record(content, record, place_in(at, packed, inside))
        })
    }

    /// Takes a message, or the declaration of a type or a channel.
    fn record(&mut self, bytes: &dyn Bytes, record: &Record, place: Place) -> Result<(), RecordingError> {
        let damaged = |problem: Problem| damaged(record.at, &problem);
        let count = record.end - record.at;
        match record.op {
            op::MESSAGE => {
                let head = read(bytes, record.at, count.min(MESSAGE_HEAD))?;
                let fields = &mut Fields::packed(&head);
                let parsed = fields.u16().and_then(|channel| Ok((channel, fields.u32()?, fields.u64()?)));
                let (number, _, time_ns) = parsed.map_err(damaged)?;
                if let Some(&channel) = self.numbers.get(&number) {
                    self.listing.message(channel, time_ns.cast_signed(), place);
                }
            }
            op::SCHEMA | op::CHANNEL => {
                if count > MAX_SMALL {
                    return Err(damaged("a declaration of more than 16 MB".to_owned()));
                }
                let content = read(bytes, record.at, count)?;
                self.declare(record.op, &mut Fields::packed(&content)).map_err(damaged)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Takes the declaration of a type or a channel. The first one of a number holds.
    fn declare(&mut self, op: u8, fields: &mut Fields<'_>) -> Result<(), Problem> {
        let number = fields.u16()?;
        if op == op::SCHEMA {
            let name = fields.text()?.to_vec();
            self.schemas.entry(number).or_insert(name);
            return Ok(());
        }
        let (schema, topic, encoding) = (fields.u16()?, fields.text()?, fields.text()?);
        let wire = match encoding {
            b"cdr" => Some(Wire::Cdr),
            b"ros1" => Some(Wire::Ros1),
            _ => None,
        };
        let kind = self.schemas.get(&schema).map(Vec::as_slice).unwrap_or_default();
        if !self.numbers.contains_key(&number) {
            let mut channel = Channel::new(topic, kind, wire.unwrap_or(Wire::Cdr));
            channel.is_read &= wire.is_some();
            self.numbers.insert(number, self.listing.channel(channel));
        }
        Ok(())
    }

    /// Takes the list of a chunk's messages of one channel.
    fn list(
        &mut self,
        bytes: &dyn Bytes,
        record: &Record,
        at: u64,
        packed: &Packed,
    ) -> Result<(), RecordingError> {
        let damaged = |problem: Problem| damaged(record.at, &problem);
        if record.end - record.at > MAX_SMALL {
            return Err(damaged("a list of more than a million messages".to_owned()));
        }
        let head = read(bytes, record.at, (record.end - record.at).min(2))?;
        let number = Fields::packed(&head).u16().map_err(damaged)?;
        if !self.numbers.contains_key(&number) {
            // The declarations stand in the chunk.
            each_record(packed, bytes, |content, record: &Record, inside| match record.op {
                op::MESSAGE => Ok(()),
                _ => self.record(content, record, Place(0, inside)),
            })?;
        }
        let Some(&channel) = self.numbers.get(&number) else { return Ok(()) };
        if !self.listing.is_read(channel) {
            self.listing.count(channel, (record.end - record.at).saturating_sub(LIST_HEAD) / LIST_ENTRY);
            return Ok(());
        }
        let content = read(bytes, record.at, record.end - record.at)?;
        let fields = &mut Fields::packed(&content[2..]);
        let times = fields.bytes().map_err(damaged)?;
        for pair in times.chunks_exact(LIST_ENTRY as usize) {
            let fields = &mut Fields::packed(pair);
            let (time_ns, inside) = (fields.u64().map_err(damaged)?, fields.u64().map_err(damaged)?);
            self.listing.message(channel, time_ns.cast_signed(), place_in(at, packed, inside));
        }
        Ok(())
    }
}

fn damaged(at: u64, problem: &str) -> RecordingError {
    RecordingError::Damaged { format: NAME, at, problem: problem.to_owned() }
}
