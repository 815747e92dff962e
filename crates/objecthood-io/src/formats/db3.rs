//! ROS 2 bags in `SQLite` files, `.db3`, among them those of RealSense.
//!
//! The table `topics` has a row for each channel: number, name, type, how messages are written. The table `messages` has a row for
//! each message: number, topic, time (ns), bytes. The rows are read where they lie: listing them reads no message.
//!
//! Source: `rosbag2_storage_sqlite3`.

mod sqlite;

use std::collections::BTreeMap;

use self::sqlite::{Database, Value};
use super::{Format, RecordingFormat};
use crate::recording::{Bytes, Channel, Listing, Log, Messages, Place, RecordingError, Wire};

pub(super) const FORMAT: Format = Format::Recording(RecordingFormat {
    extensions: &["db3"],
    is_mine: |head| head.starts_with(sqlite::MAGIC),
    log,
});

fn log(bytes: Box<dyn Bytes>) -> Result<Log, RecordingError> {
    let database = Database::open(bytes)?;
    let mut listing = Listing::default();
    let mut numbers = BTreeMap::new();
    database.rows("topics", |row| {
        let [_, name, kind, format] = row.values()?;
        if let (Value::Bytes(name), Value::Bytes(kind), Value::Bytes(format)) = (name, kind, format) {
            let mut channel = Channel::new(&name, &kind, Wire::Cdr);
            channel.is_read &= format == b"cdr";
            numbers.insert(row.id, listing.channel(channel));
        }
        Ok(())
    })?;
    let end = database.rows("messages", |row| {
        let [_, topic, time] = row.values()?;
        if let (Value::Whole(topic), Value::Whole(time_ns)) = (topic, time)
            && let Some(&channel) = numbers.get(&topic)
        {
            listing.message(channel, time_ns, row.place);
        }
        Ok(())
    });
    let cut_at = match end {
        Err(RecordingError::Cut { at }) => Some(at),
        other => other.map(|()| None)?,
    };
    Ok(listing.finish(cut_at, Box::new(Db3 { database })))
}

/// Reads messages.
struct Db3 {
    database: Database,
}

impl Messages for Db3 {
    fn read(&self, place: Place) -> Result<Vec<u8>, RecordingError> {
        /// The column of a message's bytes.
        const DATA: usize = 3;
        self.database.column(place, DATA)
    }
}
