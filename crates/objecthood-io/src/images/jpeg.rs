//! What the decoder of JPEG images lets pass: colours for printing, and files cut short, which it fills up with grey.

use super::error::ImageError;

/// Refuses a JPEG of four components and one that has no end. Walks the segments before the compressed data.
pub(super) fn check(bytes: &[u8]) -> Result<(), ImageError> {
    let broken = || ImageError::Broken { format: "JPEG", reason: "it is cut short".to_owned() };
    // After the marker that begins every image.
    let mut rest = bytes.get(2..).ok_or_else(broken)?;
    loop {
        // A marker may be preceded by any number of 0xff.
        let at = rest.iter().position(|&byte| byte != 0xff).ok_or_else(broken)?;
        let (marker, body) = rest[at..].split_first().ok_or_else(broken)?;
        let length = usize::from(u16::from_be_bytes(*body.first_chunk().ok_or_else(broken)?));
        let segment = body.get(2..length).ok_or_else(broken)?;
        match marker {
            // Start of frame, but for the tables among its numbers: precision, height, width, components.
            0xc0..=0xcf if ![0xc4, 0xc8, 0xcc].contains(marker) && segment.get(5) == Some(&4) => {
                return Err(ImageError::Cmyk);
            }
            // Start of scan. In what follows, 0xff is never followed by 0xd9 but at the end.
            0xda => {
                let ends = body[length..].windows(2).any(|pair| pair == [0xff, 0xd9]);
                return if ends { Ok(()) } else { Err(broken()) };
            }
            _ => {}
        }
        rest = &body[length..];
    }
}
