//! Points written as text, one a line.

use super::error::PcdError;
use super::header::{Field, Header, Kind};
use crate::text::{Lines, preview};

/// The records that DATA `binary` would hold. Fields that are not used stay zero, whatever their text.
pub(super) fn records(
    header: &Header<'_>,
    text: &[u8],
    is_used: impl Fn(&Field<'_>) -> bool,
) -> Result<Vec<u8>, PcdError> {
    let values = header.fields.iter().fold(0_usize, |sum, field| sum.saturating_add(field.count));
    // A digit and a separator each; the last line may lack its end.
    let needed = values.saturating_mul(2).saturating_mul(header.points()).saturating_sub(1);
    if text.len() < needed {
        return Err(PcdError::TooShort { needed, found: text.len() });
    }
    let fields: Vec<(&Field<'_>, bool)> = header.fields.iter().map(|field| (field, is_used(field))).collect();

    let stride = header.stride();
    let mut bytes = vec![0; stride * header.points()];
    let mut records = bytes.chunks_exact_mut(stride);
    for (number, line) in Lines::of(text) {
        let Some(record) = records.next() else { break };
        parse_point(line, &fields, record)
            .map_err(|problem| PcdError::BadPoint { line: header.lines + number, problem })?;
    }
    match records.len() {
        0 => Ok(bytes),
        missing => {
            Err(PcdError::MissingPoints { promised: header.points(), found: header.points() - missing })
        }
    }
}

/// Writes the used values of a line into its record; says what is wrong with the line.
fn parse_point(line: &[u8], fields: &[(&Field<'_>, bool)], record: &mut [u8]) -> Result<(), String> {
    let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    for &(field, is_used) in fields {
        let places = record[field.offset..].chunks_exact_mut(field.kind.size());
        for place in places.take(field.count) {
            let word = words.next().ok_or("it has fewer values than the header has fields")?;
            if is_used {
                let value = str::from_utf8(word).ok().and_then(|word| encode(field.kind, word, place));
                value.ok_or_else(|| {
                    let Field { name, kind, .. } = field;
                    format!("{name} is `{}`, which is no {kind:?} ({})", preview(word), kind.meaning())
                })?;
            }
        }
    }
    match words.next() {
        None => Ok(()),
        Some(_) => Err("it has more values than the header has fields".into()),
    }
}

/// Writes the number in `word` to `place`, which has its size; `None` if it is not of this kind.
fn encode(kind: Kind, word: &str, place: &mut [u8]) -> Option<()> {
    match kind {
        Kind::F4 => place.copy_from_slice(&word.parse::<f32>().ok()?.to_le_bytes()),
        Kind::F8 => place.copy_from_slice(&word.parse::<f64>().ok()?.to_le_bytes()),
        Kind::U1 => place.copy_from_slice(&word.parse::<u8>().ok()?.to_le_bytes()),
        Kind::U2 => place.copy_from_slice(&word.parse::<u16>().ok()?.to_le_bytes()),
        Kind::U4 => place.copy_from_slice(&word.parse::<u32>().ok()?.to_le_bytes()),
        Kind::U8 => place.copy_from_slice(&word.parse::<u64>().ok()?.to_le_bytes()),
        Kind::I1 => place.copy_from_slice(&word.parse::<i8>().ok()?.to_le_bytes()),
        Kind::I2 => place.copy_from_slice(&word.parse::<i16>().ok()?.to_le_bytes()),
        Kind::I4 => place.copy_from_slice(&word.parse::<i32>().ok()?.to_le_bytes()),
        Kind::I8 => place.copy_from_slice(&word.parse::<i64>().ok()?.to_le_bytes()),
    }
    Some(())
}
