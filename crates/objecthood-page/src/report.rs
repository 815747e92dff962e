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
use objecthood::{Params, Pipeline, Raster};
use objecthood_io::Capture;
use objecthood_io::output::Growing;
use objecthood_view::overlay;
use serde::Serialize;
use serde_json::{Value, json};

use crate::assets::{LICENCES, SCRIPT, STYLE};
use crate::error::Result;
use crate::film::Film;
use crate::findings::Findings;
use crate::look::{Look, seen};
use crate::maps::{NAMES, labels};
use crate::pack::{Kind, Map, pack};
use crate::session::Greeting;
use crate::settings::Settings;

/// Reports of more frames have layers of half the size.
const MOST_WHOLE: usize = 20;
/// Of those the steps of depth are so many times as large.
const COARSE: u16 = 16;
/// Columns of a thumbnail (px).
const THUMBNAIL_PX: u32 = 160;
/// Quality of JPEG for colour and normals, of 100: its noise stays below that of a camera.
const QUALITY: u8 = 85;
/// The same in reports of many frames, where the noise of normals would take a third of the file.
const QUALITY_OF_MANY: u8 = 60;
/// What the file may load, run and be asked: nothing but itself.
const POLICY: &str =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";

/// A frame that is to be in a report.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// What the frame is called.
    pub name: &'a str,
    /// The frame.
    pub capture: &'a Capture,
    /// Its number among the frames of the report, from 0.
    pub number: usize,
    /// How many frames the report has.
    pub frames: usize,
    /// How long each step took (ms), if the frame was looked at before; else the stages are timed when the page is made.
    pub laps: Option<&'a [(&'a str, f64)]>,
    /// Of a video, the track at every pixel (0 = none), and the film, whose frame `number` this is.
    pub followed: Option<(&'a Raster<u16>, &'a Film)>,
}

/// A frame of a report, drawn.
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
    /// How long the stages of the method took together.
    method_ms: f64,
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
    findings: Findings,
}

impl Page {
    /// Looks at a frame with every stage, and packs what the report shows of it.
    ///
    /// # Errors
    /// As [`look`](crate::look()).
    pub fn new(pipeline: &mut Pipeline, params: &Params, shown: &Shown<'_>) -> Result<Self> {
        let Shown { name, capture, number, frames, laps, followed } = *shown;
        let maps = NAMES.iter().filter(|name| **name != "filled").map(|name| (*name).to_owned()).collect();
        let asked = Look { frame: number, settings: Settings::of(params)?, maps };
        let (mut header, mut maps) = seen(pipeline, name, capture, &asked)?;
        let stages = names_of(&header["stages_ms"]);
        if let Some(laps) = laps {
            header["stages_ms"] = json!(laps);
        }
        let method_ms = time_of(&stages, &header["stages_ms"]);
        let tracks = followed.map(|(tracks, film)| (tracks, film.paths(number)));
        if let Some((tracks, paths)) = &tracks {
            header["paths"] = json!(paths);
            maps.push(labels("tracks", tracks));
        }
        if frames > MOST_WHOLE {
            maps.iter_mut().filter(|map| !map.name.ends_with(".colors")).for_each(halve);
            maps.iter_mut().filter(|map| map.name == "depth").for_each(coarsen);
        }
        let is_image = |map: &&mut Map| map.kind == Kind::Rgb && !map.name.ends_with(".colors");
        let quality = if frames > MOST_WHOLE { QUALITY_OF_MANY } else { QUALITY };
        maps.iter_mut().filter(is_image).try_for_each(|map| to_jpeg(map, quality))?;
        let correct = header["truth"]["correct"].as_u64().zip(header["truth"]["objects"].as_array());
        let correct = correct.map(|(correct, all)| [correct, all.len() as u64]);
        let discovery = pipeline.discover(&capture.frame, params)?;
        let small = overlay(&capture.frame, tracks.as_ref().map_or(&discovery.labels, |(tracks, _)| tracks));
        let small = DynamicImage::from(small).thumbnail(THUMBNAIL_PX, THUMBNAIL_PX).to_rgb8();
        let thumbnail = STANDARD.encode(jpeg(small.as_raw(), small.width(), small.height(), QUALITY)?);
        let objects = tracks.as_ref().map_or(discovery.objects.len(), |(_, paths)| paths.len());
        let row = Row { name: name.to_owned(), objects, correct, method_ms, thumbnail };
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
        Ok(Self { file, params: params.clone(), words, rows: Vec::new(), findings: Findings::default() })
    }

    /// Says figures beside the frames: Markdown, in which every line stays a line.
    pub fn tell(&mut self, markdown: &str) {
        self.findings.tell(markdown);
    }

    /// Shows a plot beside the frames: an SVG file.
    pub fn plot(&mut self, svg: &str) {
        self.findings.plot(svg);
    }

    /// Says that the frames are those of a video, and what happens in it.
    pub fn film(&mut self, film: Film) {
        self.findings.film = Some(film);
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
        let Self { mut file, params, words, rows, findings } = self;
        let names = rows.iter().map(|row| row["name"].as_str().unwrap_or_default().to_owned()).collect();
        let title = words.join(" ");
        let all = json!({ "greeting": Greeting::new(&title, &words, (names, false), &params)?, "rows": rows, "findings": findings });
        // Nothing in it can end the element.
        let all = all.to_string().replace('<', "\\u003c");
        let tail = format!(
            "<script type=\"application/json\" id=\"all\">{all}</script>\n<script>\n{SCRIPT}</script>\n</html>\n"
        );
        file.append(tail.as_bytes())?;
        Ok(file.finish()?)
    }
}

/// The names of what was timed.
fn names_of(laps: &Value) -> Vec<Value> {
    laps.as_array().into_iter().flatten().map(|lap| lap[0].clone()).collect()
}

/// How long the stages took together (ms): who looked at the frame before may have timed more, as reading it and writing files of it.
fn time_of(stages: &[Value], laps: &Value) -> f64 {
    let of_stages = laps.as_array().into_iter().flatten().filter(|lap| stages.contains(&lap[0]));
    of_stages.filter_map(|lap| lap[1].as_f64()).sum()
}

fn deflated(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes)?;
    Ok(encoder.finish()?)
}

/// Depth in steps of a 4096th of the farthest one, which no eye tells from finer ones, and which pack well; what has depth keeps some.
fn coarsen(map: &mut Map) {
    for step in map.bytes.chunks_exact_mut(2) {
        let fine = u16::from_le_bytes([step[0], step[1]]);
        let coarse = if fine == 0 { 0 } else { (fine / COARSE).max(1) };
        step.copy_from_slice(&coarse.to_le_bytes());
    }
    map.unit_m = map.unit_m.map(|unit_m| unit_m * f32::from(COARSE));
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

fn to_jpeg(map: &mut Map, quality: u8) -> Result<()> {
    map.bytes = jpeg(&map.bytes, map.width as u32, map.height as u32, quality)?;
    map.kind = Kind::Jpeg;
    Ok(())
}

fn jpeg(rgb: &[u8], width: u32, height: u32, quality: u8) -> Result<Vec<u8>> {
    let mut file = Vec::new();
    JpegEncoder::new_with_quality(&mut file, quality).encode(rgb, width, height, ExtendedColorType::Rgb8)?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_depth_is_as_far_and_never_none() {
        let fine = [0_u16, 1, 160, 65535];
        let bytes = fine.iter().flat_map(|p| p.to_le_bytes()).collect();
        let mut map =
            Map { name: String::new(), kind: Kind::U16, width: 4, height: 1, bytes, unit_m: Some(0.001) };
        coarsen(&mut map);
        let steps: Vec<u16> = map.bytes.chunks(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        assert_eq!(steps, [0, 1, 10, 4095]);
        assert!((map.unit_m.unwrap() - 0.016).abs() < 1e-6);
    }

    #[test]
    fn reading_and_writing_are_no_time_of_the_method() {
        let own = json!([["normals", 0.0], ["objects", 0.0]]);
        let timed = json!([["reading", 20.0], ["normals", 3.0], ["objects", 4.5], ["encoding", 160.0]]);
        assert!((time_of(&names_of(&own), &timed) - 7.5).abs() < 1e-9);
    }

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
