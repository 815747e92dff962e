//! The text files of a folder: images and poses with their times, a line each.

use std::path::PathBuf;

use crate::capture::Pose;
use crate::error::{Error, Result};
use crate::text;

/// Something with its time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Timed<T> {
    /// When it was taken (µs).
    pub(super) time_us: i64,
    pub(super) what: T,
}

/// Reads a list of images, paths below the folder, in the order of their times.
///
/// # Errors
/// [`Error::BadListLine`].
pub(super) fn parse_images(list: &[u8]) -> Result<Vec<Timed<PathBuf>>> {
    parse(list, |path| Some(text::path(path))).map_err(|(line, text)| Error::BadListLine { line, text })
}

/// Reads a list of poses, `tx ty tz qx qy qz qw` behind each time, in the order of their times.
///
/// # Errors
/// [`Error::BadPoseLine`].
pub(super) fn parse_poses(list: &[u8]) -> Result<Vec<Timed<Pose>>> {
    parse(list, parse_pose).map_err(|(line, text)| Error::BadPoseLine { line, text })
}

/// Reads lines of a time in seconds and something behind it, in the order of the times. The error is the number of the
/// line that is wrong, from 1, and how it begins.
fn parse<T>(
    list: &[u8],
    what: impl Fn(&[u8]) -> Option<T>,
) -> std::result::Result<Vec<Timed<T>>, (usize, String)> {
    let lines = text::without_byte_order_mark(list).split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let mut entries = Vec::new();
    for (k, line) in lines.enumerate().filter(|(_, line)| !line.is_empty() && !line.starts_with(b"#")) {
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (time, rest) = (parse_time_us(&line[..end]), line[end..].trim_ascii_start());
        match (time, what(rest)) {
            (Some(time_us), Some(what)) if !rest.is_empty() => entries.push(Timed { time_us, what }),
            _ => return Err((k + 1, String::from_utf8_lossy(line).chars().take(60).collect())),
        }
    }
    entries.sort_by_key(|entry| entry.time_us);
    Ok(entries)
}

/// Seconds to microseconds. Those since 1970 are far below 2^53, so that nothing is lost.
fn parse_time_us(word: &[u8]) -> Option<i64> {
    let time_s = number(word).filter(|time_s| time_s.abs() < 1e12)?;
    Some((time_s * 1e6).round() as i64)
}

fn parse_pose(words: &[u8]) -> Option<Pose> {
    let words = words.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let numbers = words.map(|word| number(word).filter(|x| x.is_finite())).collect::<Option<Vec<f64>>>()?;
    let &[tx, ty, tz, qx, qy, qz, qw] = &numbers[..] else { return None };
    let length = (qx * qx + qy * qy + qz * qz + qw * qw).sqrt();
    // Files hold four decimals or more; anything else is no unit quaternion.
    (0.99..=1.01)
        .contains(&length)
        .then(|| Pose { position_m: [tx, ty, tz], rotation_xyzw: [qx, qy, qz, qw].map(|q| q / length) })
}

fn number(word: &[u8]) -> Option<f64> {
    str::from_utf8(word).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_read() {
        let list = b"# a comment\r\n1305031232.904183 depth/b c.png\r\n\n 1305031232.868557\tdepth/a.png\n";
        let entry = |time_us, file: &str| Timed { time_us, what: PathBuf::from(file) };
        assert_eq!(
            parse_images(list).unwrap(),
            [entry(1_305_031_232_868_557, "depth/a.png"), entry(1_305_031_232_904_183, "depth/b c.png")]
        );
        for (list, line) in
            [("1.0", 1), ("# x\nyesterday a.png", 2), ("nan a", 1), ("1e300 a", 1), ("\n\n-", 3)]
        {
            let message = parse_images(list.as_bytes()).unwrap_err().to_string();
            assert!(message.starts_with(&format!("line {line}: ")), "{message}");
        }
        assert_eq!(parse_images(b"").unwrap(), []);
    }

    /// The mark made a line of the comment that an editor saved it before.
    #[test]
    fn a_list_with_a_byte_order_mark_is_read() {
        assert_eq!(parse_images(b"\xef\xbb\xbf# a comment\n1.0 a.png\n").unwrap().len(), 1);
        assert_eq!(parse_images(b"\xef\xbb\xbf1.0 a.png\n").unwrap()[0].time_us, 1_000_000);
    }

    /// Such names were read with replacement characters, and then no such file was there.
    #[cfg(unix)]
    #[test]
    fn a_name_that_is_not_utf_8_is_kept() {
        use std::os::unix::ffi::OsStrExt;
        let images = parse_images(b"1.0 depth/\xe9t\xe9.png\n").unwrap();
        assert_eq!(images[0].what.as_os_str().as_bytes(), b"depth/\xe9t\xe9.png");
    }

    #[test]
    fn poses_are_read_and_made_unit() {
        let poses = parse_poses(b"# t p q\n1.5 1 2 3 0 0 0.6004 0.8003\n0.5 0 0 0 0 0 0 1\n").unwrap();
        assert_eq!(
            poses[0],
            Timed {
                time_us: 500_000,
                what: Pose { position_m: [0.0; 3], rotation_xyzw: [0.0, 0.0, 0.0, 1.0] }
            }
        );
        assert_eq!(poses[1].what.position_m, [1.0, 2.0, 3.0]);
        let length = poses[1].what.rotation_xyzw.iter().map(|q| q * q).sum::<f64>();
        assert!((length - 1.0).abs() < 1e-15, "{length}");
        for line in [
            "1 0 0 0 0 0 0",
            "1 0 0 0 0 0 0 0",
            "1 0 0 0 0 0 0 2",
            "1 nan 0 0 0 0 0 1",
            "1 0 0 0 0 0 0 1 1",
            "1",
        ] {
            let message = parse_poses(line.as_bytes()).unwrap_err().to_string();
            assert!(message.starts_with(&format!("line 1: `{line}` is not")), "{message}");
        }
    }
}
