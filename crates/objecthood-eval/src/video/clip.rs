//! A clip with truth, and what a tracker says of it: folders of files.

use std::fs;
use std::path::{Path, PathBuf};

use objecthood::Raster;
use objecthood_io::label_image;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::frame::Roles;
use crate::error::{Error, Result};
use crate::support::LEAST_SEEN_PX;

/// The image of which [`LEAST_SEEN_PX`] is a part; in other images it is the same share.
const VGA_PX: usize = 640 * 480;

/// What is true of a clip, but for the images. `objecthood synth` writes the folder.
#[derive(Clone, Debug, Default)]
pub struct TrueClip {
    folder: PathBuf,
    /// Each frame, in time.
    pub frames: Vec<TrueFrame>,
    /// Instances of things to find and follow.
    pub objects: Vec<u16>,
    /// Instances of hands and people.
    pub agents: Vec<u16>,
    /// Things that count as one until they move apart.
    pub groups: Vec<Group>,
    /// What happened.
    pub events: Vec<Event>,
    /// What stands on what, in any order.
    pub edges: Vec<Edge>,
}

/// A frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrueFrame {
    /// What its files are called.
    pub stem: String,
    /// When it was taken.
    pub time_s: f64,
    /// The instances on which nothing but gravity acts.
    pub airborne: Vec<u16>,
}

/// Things that count as one until they move apart.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct Group {
    /// Their instances.
    pub members: Vec<u16>,
    /// Why they count as one.
    pub joint: Joint,
    /// First frame in which they have moved apart; `None` when they never do.
    pub apart_from: Option<usize>,
}

/// Why things count as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Joint {
    /// Their faces go on in each other.
    Flush,
    /// One closes the other: a lid, a drawer.
    Closed,
}

/// Something that happened, or that a tracker says has happened: a line of `events.jsonl`. Other fields are passed over.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
pub struct Event {
    /// The frame in which it lies, from 0.
    pub frame: usize,
    /// What, by name: `picked_up`.
    #[serde(rename = "type")]
    pub kind: String,
    /// To whom: an instance, or a track.
    pub object: u16,
    /// Who or what else had part in it; 0 = the table.
    pub other: Option<u16>,
    /// First frame of what lasts.
    pub start: Option<usize>,
    /// Last frame of what lasts.
    pub end: Option<usize>,
}

/// What stands on what in a frame: a line of `support.jsonl`. Other fields are passed over.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
pub struct Edge {
    /// The frame, from 0.
    pub frame: usize,
    /// The instance, or the track, that something holds.
    pub child: u16,
    /// What holds it; 0 = the table, the floor or other furniture.
    pub parent: u16,
    /// How: `on`, `in`, `leans`, `held`.
    pub kind: Option<String>,
}

#[derive(Deserialize)]
struct ClipFile {
    #[serde(default)]
    agents: Vec<u16>,
    #[serde(default)]
    groups: Vec<Group>,
    solids: Vec<SolidFile>,
}

#[derive(Deserialize)]
struct SolidFile {
    instance: u16,
    role: String,
}

#[derive(Deserialize)]
struct FrameLine {
    frame: usize,
    solids: Vec<MotionFile>,
}

#[derive(Deserialize)]
struct MotionFile {
    instance: u16,
    #[serde(default)]
    airborne: bool,
}

impl TrueClip {
    /// Whether a folder is that of a clip with truth.
    pub fn is_at(folder: &Path) -> bool {
        folder.join("clip.json").is_file()
    }

    /// Reads everything but the images.
    ///
    /// # Errors
    /// [`Error::ReadTruth`], [`Error::Line`], [`Error::NotClip`] when a file is not there or says nonsense.
    pub fn read(folder: &Path) -> Result<Self> {
        let path = folder.join("clip.json");
        let clip: ClipFile = parse(&text_of(&path)?, &path, 1)?;
        let mut frames = frames(&folder.join("rgb.txt"))?;
        let path = folder.join("truth.jsonl");
        for line in lines::<FrameLine>(&text_of(&path)?, &path)? {
            let Some(frame) = frames.get_mut(line.frame) else {
                let why = format!("frame {} is not in rgb.txt", line.frame);
                return Err(Error::NotClip { path, why });
            };
            let flies = line.solids.iter().filter(|solid| solid.airborne);
            frame.airborne = flies.map(|solid| solid.instance).collect();
        }
        let path_of = |name: &str| folder.join(name);
        let (events, edges) = (path_of("events.jsonl"), path_of("support.jsonl"));
        let objects = clip.solids.iter().filter(|solid| solid.role == "object");
        Ok(Self {
            folder: folder.to_owned(),
            frames,
            objects: objects.map(|solid| solid.instance).collect(),
            agents: clip.agents,
            groups: clip.groups,
            events: lines(&text_of(&events)?, &events)?,
            edges: lines(&text_of(&edges)?, &edges)?,
        })
    }

    /// The instance at every pixel of a frame.
    ///
    /// # Errors
    /// [`Error::ReadTruth`] when the image is not there, [`Error::Input`] when it is no label image.
    pub fn instances(&self, frame: usize) -> Result<Raster<u16>> {
        let path = self.folder.join("truth").join(format!("{}.png", self.frames[frame].stem));
        let bytes = fs::read(&path).map_err(|reason| Error::ReadTruth { path: path.clone(), reason })?;
        Ok(label_image::decode(&bytes).map_err(|error| error.at(&path))?)
    }

    /// What the instances of a frame are. Things of which less is seen than [`LEAST_SEEN_PX`] of a VGA image are not asked for.
    /// O(n) for n pixels.
    pub fn roles(&self, frame: usize, instances: &Raster<u16>) -> Roles {
        let joined = self.groups.iter().filter(|group| group.apart_from.is_none_or(|apart| frame < apart));
        let groups: Vec<Vec<u16>> = joined.map(|group| group.members.clone()).collect();
        let all = Roles {
            objects: self.objects.iter().copied().collect(),
            unpunished: self.agents.iter().copied().collect(),
            groups,
        };
        let mut px = vec![0_usize; usize::from(u16::MAX) + 1];
        for &instance in instances.as_slice() {
            px[usize::from(instance)] += 1;
        }
        let least_px = (LEAST_SEEN_PX as usize * instances.len()).div_ceil(VGA_PX);
        let mut roles = all.clone();
        let wholes = all.disjoint_groups();
        let whole_of = |object: &u16| wholes.iter().find(|whole| whole.contains(object));
        for object in &all.objects {
            let own = [*object];
            let whole = whole_of(object).map_or(&own[..], Vec::as_slice);
            if whole.iter().map(|&member| px[usize::from(member)]).sum::<usize>() < least_px {
                roles.objects.remove(object);
                roles.unpunished.insert(*object);
            }
        }
        roles
    }

    /// Seconds from one frame to another.
    pub(crate) fn seconds(&self, from: usize, to: usize) -> f64 {
        self.frames[to].time_s - self.frames[from].time_s
    }
}

/// The folder in which a tracker says what it sees: `labels/<stem>.png` and, if it tells them, `events.jsonl` and
/// `support.jsonl`.
#[derive(Clone, Debug, Default)]
pub struct Said {
    folder: PathBuf,
    /// What happened; `None` when there is no such file.
    pub events: Option<Vec<Event>>,
    /// What stands on what; `None` when there is no such file.
    pub edges: Option<Vec<Edge>>,
}

impl Said {
    /// Reads everything but the images.
    ///
    /// # Errors
    /// [`Error::ReadTracks`] when a file cannot be read, [`Error::Line`] when it says nonsense.
    pub fn read(folder: &Path) -> Result<Self> {
        Ok(Self {
            folder: folder.to_owned(),
            events: said_lines(folder.join("events.jsonl"))?,
            edges: said_lines(folder.join("support.jsonl"))?,
        })
    }

    /// The track at every pixel of a frame.
    ///
    /// # Errors
    /// [`Error::ReadTracks`] when the image is not there, [`Error::Input`] when it is no label image.
    pub fn tracks(&self, frame: &TrueFrame) -> Result<Raster<u16>> {
        let path = self.folder.join("labels").join(format!("{}.png", frame.stem));
        let bytes = fs::read(&path).map_err(|reason| Error::ReadTracks { path: path.clone(), reason })?;
        Ok(label_image::decode(&bytes).map_err(|error| error.at(&path))?)
    }
}

fn said_lines<T: DeserializeOwned>(path: PathBuf) -> Result<Option<Vec<T>>> {
    match fs::read_to_string(&path) {
        Ok(text) => lines(&text, &path).map(Some),
        Err(reason) if reason.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(reason) => Err(Error::ReadTracks { path, reason }),
    }
}

fn text_of(path: &Path) -> Result<String> {
    fs::read_to_string(path).map_err(|reason| Error::ReadTruth { path: path.to_owned(), reason })
}

/// A value a line; empty lines are passed over.
fn lines<T: DeserializeOwned>(text: &str, path: &Path) -> Result<Vec<T>> {
    let filled = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    filled.map(|(k, line)| parse(line, path, k + 1)).collect()
}

fn parse<T: DeserializeOwned>(text: &str, path: &Path, line: usize) -> Result<T> {
    serde_json::from_str(text).map_err(|reason| Error::Line { path: path.to_owned(), line, reason })
}

/// The frames of a list of images: time (s) and file a line.
fn frames(path: &Path) -> Result<Vec<TrueFrame>> {
    let text = text_of(path)?;
    let mut frames: Vec<TrueFrame> = Vec::new();
    for (k, line) in text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with('#')) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let frame = match words[..] {
            [] => continue,
            [time, file] => time.parse().ok().filter(|time: &f64| time.is_finite()).and_then(|time_s| {
                let stem = Path::new(file).file_stem()?.to_str()?.to_owned();
                Some(TrueFrame { stem, time_s, airborne: Vec::new() })
            }),
            _ => None,
        };
        let Some(frame) = frame else {
            let why = format!("line {}: give time and file", k + 1);
            return Err(Error::NotClip { path: path.to_owned(), why });
        };
        if frames.last().is_some_and(|last| last.time_s >= frame.time_s) {
            let why = format!("line {}: times have to rise", k + 1);
            return Err(Error::NotClip { path: path.to_owned(), why });
        }
        frames.push(frame);
    }
    if frames.is_empty() {
        return Err(Error::NotClip { path: path.to_owned(), why: "it lists no frame".to_owned() });
    }
    Ok(frames)
}
