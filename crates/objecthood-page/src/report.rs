//! A report: one HTML file that shows frames as the live page does, without a server and without a network.
//!
//! Each frame is a picture as [`look`](crate::look()) packs it, deflated, in base64 in an element of its own, which the page unpacks when it is
//! looked at. What is said of all frames stands behind them.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ExtendedColorType};
use objecthood::{Params, Pipeline};
use objecthood_io::Capture;
use objecthood_io::output::Growing;
use objecthood_view::overlay;
use serde::Serialize;
use serde_json::{Value, json};

use crate::assets::{LICENCES, SCRIPT, STYLE};
use crate::error::Result;
use crate::look::{Look, seen};
use crate::maps::NAMES;
use crate::pack::{Kind, Map, pack};
use crate::session::Greeting;
use crate::settings::Settings;

/// Reports of more frames have layers of half the size.
const MOST_WHOLE: usize = 20;
/// Columns of a thumbnail (px).
const THUMBNAIL_PX: u32 = 160;
/// Quality of JPEG for colour and normals, of 100: its noise stays below that of a camera.
const QUALITY: u8 = 85;
/// What the file may load, run and be asked: nothing but itself.
const POLICY: &str =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";

/// A frame of a report.
pub struct Page {
    /// The picture, in base64.
    picture: String,
    row: Row,
}

/// What the list of frames says of one.
#[derive(Serialize)]
struct Row {
    name: String,
    objects: usize,
    /// Objects that are correct, and all there are, where that is known.
    correct: Option<[u64; 2]>,
    together_ms: f64,
    /// A JPEG file in base64.
    thumbnail: String,
}

/// The report of a run, which grows frame by frame.
#[derive(Debug)]
pub struct Report {
    file: Growing,
    params: Params,
    words: Vec<String>,
    rows: Vec<Value>,
}

impl Page {
    /// A frame called `name`, the `number`th of `frames`; `laps` says how long each step took (ms).
    ///
    /// # Errors
    /// As [`look`](crate::look()).
    pub fn new(
        pipeline: &mut Pipeline,
        name: &str,
        capture: &Capture,
        params: &Params,
        (number, frames): (usize, usize),
        laps: &[(&str, f64)],
    ) -> Result<Self> {
        let maps = NAMES.iter().filter(|name| **name != "filled").map(|name| (*name).to_owned()).collect();
        let asked = Look { frame: number, settings: Settings::of(params)?, maps };
        let (mut header, mut maps) = seen(pipeline, name, capture, &asked)?;
        let together_ms = laps.iter().map(|lap| lap.1).sum();
        header["stages_ms"] = json!(laps);
        header["together_ms"] = json!(together_ms);
        if frames > MOST_WHOLE {
            maps.iter_mut().filter(|map| !map.name.ends_with(".colors")).for_each(halve);
        }
        let is_image = |map: &&mut Map| map.kind == Kind::Rgb && !map.name.ends_with(".colors");
        maps.iter_mut().filter(is_image).try_for_each(to_jpeg)?;
        let correct = header["truth"]["correct"].as_u64().zip(header["truth"]["objects"].as_array());
        let correct = correct.map(|(correct, all)| [correct, all.len() as u64]);
        let discovery = pipeline.discover(&capture.frame, params)?;
        let small = overlay(&capture.frame, &discovery.labels);
        let small = DynamicImage::from(small).thumbnail(THUMBNAIL_PX, THUMBNAIL_PX).to_rgb8();
        let thumbnail = STANDARD.encode(jpeg(small.as_raw(), small.width(), small.height())?);
        let row =
            Row { name: name.to_owned(), objects: discovery.objects.len(), correct, together_ms, thumbnail };
        Ok(Self { picture: STANDARD.encode(deflated(&pack(header, &maps)?)?), row })
    }
}

impl Report {
    /// Begins a report in a file; `words` of a command line name the frames.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn begin(mut file: Growing, words: Vec<String>, params: &Params) -> Result<Self> {
        let head = format!(
            "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" \
             content=\"{POLICY}\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>objecthood report</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n{STYLE}</style>\n\
             <div id=\"page\"><noscript>This report needs JavaScript.</noscript></div>\n<!--\n{LICENCES}-->\n"
        );
        file.append(head.as_bytes())?;
        Ok(Self { file, params: params.clone(), words, rows: Vec::new() })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn add(&mut self, page: &Page) -> Result<()> {
        self.file.append(b"<script type=\"text/plain\" class=\"frame\">")?;
        self.file.append(page.picture.as_bytes())?;
        self.file.append(b"</script>\n")?;
        self.rows.push(serde_json::to_value(&page.row)?);
        Ok(())
    }

    /// Ends the file, which takes its name.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(self) -> Result<()> {
        let Self { mut file, params, words, rows } = self;
        let names = rows.iter().map(|row| row["name"].as_str().unwrap_or_default()).collect();
        let title = words.join(" ");
        let all = json!({ "greeting": Greeting::new(&title, &words, names, &params)?, "rows": rows });
        // Nothing in it can end the element.
        let all = all.to_string().replace('<', "\\u003c");
        let tail = format!(
            "<script type=\"application/json\" id=\"all\">{all}</script>\n<script>\n{SCRIPT}</script>\n</html>\n"
        );
        file.append(tail.as_bytes())?;
        Ok(file.finish()?)
    }
}

fn deflated(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes)?;
    Ok(encoder.finish()?)
}

/// Every second pixel of every second row.
fn halve(map: &mut Map) {
    let bytes_a_pixel = map.bytes.len() / (map.width * map.height).max(1);
    let row = map.width * bytes_a_pixel;
    if row == 0 {
        return;
    }
    let rows = map.bytes.chunks_exact(row).step_by(2);
    let kept = rows.flat_map(|row| row.chunks_exact(bytes_a_pixel).step_by(2)).flatten().copied();
    map.bytes = kept.collect();
    (map.width, map.height) = (map.width.div_ceil(2), map.height.div_ceil(2));
}

fn to_jpeg(map: &mut Map) -> Result<()> {
    map.bytes = jpeg(&map.bytes, map.width as u32, map.height as u32)?;
    map.kind = Kind::Jpeg;
    Ok(())
}

fn jpeg(rgb: &[u8], width: u32, height: u32) -> Result<Vec<u8>> {
    let mut file = Vec::new();
    JpegEncoder::new_with_quality(&mut file, QUALITY).encode(rgb, width, height, ExtendedColorType::Rgb8)?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_map_has_every_second_pixel() {
        let pixels = [1_u16, 2, 3, 4, 5, 6, 7, 8, 9];
        let bytes = pixels.iter().flat_map(|p| p.to_le_bytes()).collect();
        let mut map = Map { name: String::new(), kind: Kind::U16, width: 3, height: 3, bytes, unit_m: None };
        halve(&mut map);
        assert_eq!((map.width, map.height), (2, 2));
        assert_eq!(map.bytes, [1, 0, 3, 0, 7, 0, 9, 0]);
    }
}
