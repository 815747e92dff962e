//! The form in which maps are sent: a JSON header, and behind it the bytes of the maps.
//!
//! | bytes | content |
//! |---|---|
//! | 4 | length of the header, little endian, a multiple of 4 |
//! | that many | the header: JSON, filled up with spaces; its `maps` say name, kind, size and place of every map |
//! | the rest | the maps, each begins at a multiple of 4; numbers are little endian |

use serde::Serialize;
use serde_json::{Value, json};

use crate::error::Result;

/// How a pixel of a map is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Kind {
    /// A byte.
    U8,
    /// Two bytes.
    U16,
    /// Four bytes.
    U32,
    /// A byte with a sign.
    I8,
    /// Three bytes: red, green, blue.
    Rgb,
    /// Not a number for each pixel, but a JPEG file of red, green, blue; in reports.
    Jpeg,
}

/// A map: numbers for every pixel, or for every label.
#[derive(Debug)]
pub(crate) struct Map {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) bytes: Vec<u8>,
    /// What one step of its numbers is in metres, of a map of distances.
    pub(crate) unit_m: Option<f32>,
}

/// Packs maps behind a header, whose `maps` are set here.
///
/// # Errors
/// [`Error::Json`](crate::Error::Json).
pub(crate) fn pack(mut header: Value, maps: &[Map]) -> Result<Vec<u8>> {
    let mut offset = 0;
    let places = maps.iter().map(|map| {
        let Map { name, kind, width, height, bytes, unit_m } = map;
        let place = json!({
            "name": name, "kind": kind, "width": width, "height": height, "unit_m": unit_m,
            "offset": offset, "length": bytes.len(),
        });
        offset += padded(bytes.len());
        place
    });
    header["maps"] = places.collect();
    let mut text = serde_json::to_vec(&header)?;
    text.resize(padded(text.len()), b' ');
    let mut packed = Vec::with_capacity(4 + text.len() + offset);
    packed.extend((text.len() as u32).to_le_bytes());
    packed.append(&mut text);
    for Map { bytes, .. } in maps {
        packed.extend_from_slice(bytes);
        packed.resize(padded(packed.len()), 0);
    }
    Ok(packed)
}

fn padded(length: usize) -> usize {
    length.next_multiple_of(4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_lie_where_the_header_says() {
        let map = |name: &str, bytes: &[u8]| Map {
            name: name.to_owned(),
            kind: Kind::U8,
            width: bytes.len(),
            height: 1,
            bytes: bytes.to_vec(),
            unit_m: None,
        };
        let packed = pack(json!({ "frame": 3 }), &[map("a", &[1, 2, 3]), map("b", &[4; 5])]).unwrap();
        let length = u32::from_le_bytes(packed[..4].try_into().unwrap()) as usize;
        assert_eq!(length % 4, 0);
        let header: Value = serde_json::from_slice(&packed[4..4 + length]).unwrap();
        assert_eq!((&header["frame"], &header["maps"][0]["kind"]), (&json!(3), &json!("u8")));
        let maps = &packed[4 + length..];
        for (k, expected) in [(0, &[1, 2, 3][..]), (1, &[4; 5])] {
            let place = |key: &str| header["maps"][k][key].as_u64().unwrap() as usize;
            assert_eq!(place("offset") % 4, 0);
            assert_eq!(&maps[place("offset")..][..place("length")], expected);
        }
    }
}
