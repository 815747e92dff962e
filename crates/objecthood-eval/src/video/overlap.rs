//! What every track has in common with every object, frame by frame: all that the metrics of detection and association need.

use super::frame::{LabelledFrame, Place, Places, Roles};
use super::groups::Sets;
use crate::contingency::{Classes, Contingency};
use crate::error::{Error, Result};

/// `IoU` from which on a track shows an object.
pub(crate) const SHOWN_IOU: f64 = 0.5;

/// Whatever is seen in a frame, by its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Seen {
    /// The object, as the truth numbers it, or the track.
    pub(crate) id: u16,
    /// Its visible pixels, at least one.
    pub(crate) px: u32,
}

/// Pixels that an object and a track share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Common {
    /// Index in [`FrameOverlap::objects`].
    pub(crate) object: usize,
    /// Index in [`FrameOverlap::tracks`].
    pub(crate) track: usize,
    /// At least one.
    pub(crate) px: u32,
}

/// The table of one frame. Only what is there is kept, so an hour of video needs some 100 MB.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct FrameOverlap {
    pub(crate) objects: Vec<Seen>,
    pub(crate) tracks: Vec<Seen>,
    /// By object, then by track.
    pub(crate) common: Vec<Common>,
    /// Tracks that are not judged in this frame, because more than half of their pixels are on what is not punished.
    pub(crate) unpunished: Vec<u16>,
    /// Instances that are part of a group, and the object that stands for it; by instance.
    grouped: Vec<(u16, u16)>,
}

impl FrameOverlap {
    /// The object that stands for an instance in this frame.
    pub(crate) fn name_of(&self, instance: u16) -> u16 {
        let place = self.grouped.binary_search_by_key(&instance, |grouped| grouped.0);
        place.map_or(instance, |k| self.grouped[k].1)
    }

    /// The visible pixels of the object that stands for an instance.
    pub(crate) fn seen_px(&self, instance: u16) -> u32 {
        let name = self.name_of(instance);
        self.objects.iter().find(|seen| seen.id == name).map_or(0, |seen| seen.px)
    }

    /// Intersection over union of a pair.
    pub(crate) fn iou(&self, pair: &Common) -> f64 {
        let union = self.objects[pair.object].px + self.tracks[pair.track].px - pair.px;
        f64::from(pair.px) / f64::from(union)
    }

    /// The ids of a pair: object and track.
    pub(crate) fn ids(&self, pair: &Common) -> (u16, u16) {
        (self.objects[pair.object].id, self.tracks[pair.track].id)
    }

    /// A value for every object (row) and track (column), 0 where they have nothing in common.
    pub(crate) fn matrix(&self, value: impl Fn(&Common) -> f64) -> Vec<f64> {
        let mut values = vec![0.0; self.objects.len() * self.tracks.len()];
        for pair in &self.common {
            values[pair.object * self.tracks.len() + pair.track] = value(pair);
        }
        values
    }
}

/// The tables of a video.
#[derive(Clone, Debug, Default)]
pub struct Overlaps {
    pub(crate) frames: Vec<FrameOverlap>,
}

impl Overlaps {
    /// How many frames there are.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }
}

/// Takes the frames of a video one after the other.
#[derive(Debug, Default)]
pub struct OverlapCounter {
    frames: Vec<FrameOverlap>,
    sets: Sets,
}

impl OverlapCounter {
    /// Adds the next frame. O(n log k) for n pixels with k regions.
    ///
    /// # Errors
    /// [`Error::PredictionSize`] when both images differ in size; [`Error::TooManyRegions`] when they are noise.
    pub fn add(&mut self, frame: &LabelledFrame, roles: &Roles) -> Result<()> {
        let places = Places::of(roles);
        let (mut overlap, things) = count(frame, &places)?;
        let overlap_columns = overlap.tracks.len();
        let too_many = || Error::TooManyRegions { rows: places.things.len(), columns: overlap_columns };
        let number =
            |sets: &mut Sets, thing: usize| sets.number_of(&places.things[thing]).ok_or_else(too_many);
        for (seen, thing) in overlap.objects.iter_mut().zip(things) {
            seen.id = number(&mut self.sets, thing)?;
        }
        for thing in (0..places.things.len()).filter(|&thing| places.things[thing].len() > 1) {
            let id = number(&mut self.sets, thing)?;
            overlap.grouped.extend(places.things[thing].iter().map(|&member| (member, id)));
        }
        overlap.grouped.sort_unstable();
        self.frames.push(overlap);
        Ok(())
    }

    /// The tables, after the last frame; groups have the name of one of their members each.
    pub fn finish(self) -> Overlaps {
        let Self { mut frames, sets } = self;
        let names = sets.names(&frames);
        for frame in &mut frames {
            let objects = frame.objects.iter_mut().map(|seen| &mut seen.id);
            for id in objects.chain(frame.grouped.iter_mut().map(|grouped| &mut grouped.1)) {
                *id = names[usize::from(*id)];
            }
        }
        Overlaps { frames }
    }
}

/// Counts the pixels of a frame. Objects have no id yet: the second list says which of the things of `places` each is.
fn count(frame: &LabelledFrame, places: &Places) -> Result<(FrameOverlap, Vec<usize>)> {
    /// Stands behind all objects.
    const UNPUNISHED: u32 = u32::MAX - 1;
    let LabelledFrame { tracks, instances } = frame;
    if tracks.size() != instances.size() {
        return Err(Error::PredictionSize { labels: tracks.size(), truth: instances.size() });
    }
    let rows = Classes::of(instances.len(), |i| match places.at(instances[i]) {
        Place::Background => None,
        Place::Unpunished => Some(UNPUNISHED),
        Place::Object(thing) => Some(thing),
    });
    let columns = Classes::of(tracks.len(), |i| (tracks[i] > 0).then(|| u32::from(tracks[i])));
    let table = Contingency::of(&rows, &columns)?;
    let unpunished_row = rows.labels.iter().position(|&label| label == UNPUNISHED);

    let mut overlap = FrameOverlap::default();
    let mut judged = Vec::new();
    for (column, (&label, &px)) in columns.labels.iter().zip(&columns.pixels).enumerate() {
        let off_px = unpunished_row.map_or(0, |row| table.row(row)[column]);
        if 2 * u64::from(off_px) <= u64::from(px) {
            judged.push(column);
            overlap.tracks.push(Seen { id: label as u16, px });
        } else {
            overlap.unpunished.push(label as u16);
        }
    }
    let objects = unpunished_row.unwrap_or(rows.len());
    overlap.objects = rows.pixels[..objects].iter().map(|&px| Seen { id: 0, px }).collect();
    for object in 0..objects {
        let row = table.row(object);
        let shared =
            judged.iter().enumerate().map(|(track, &column)| Common { object, track, px: row[column] });
        overlap.common.extend(shared.filter(|common| common.px > 0));
    }
    Ok((overlap, rows.labels[..objects].iter().map(|&thing| thing as usize).collect()))
}
