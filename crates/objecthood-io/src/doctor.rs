//! What an input is, and what of it cannot be right: [`Examination`] looks at frames one after the other and makes a [`Report`].
//!
//! Each frame is measured: its depths, its noise, where its support plane lies, whether its images lie on each other. What the frames have in
//! common is told once. A [`Finding`] is *sure* where no correct input looks like that, and *suspect* where a rare one does.
//!
//! It cannot be seen whether the colours are RGB or BGR, nor whether all lengths are wrong by a factor below 2.

mod certainty;
mod registration;
mod sequence;
mod values;

use objecthood::plausibility::find_doubts;
use objecthood::{Camera, Discovery, Notice};
use serde::Serialize;

use self::registration::Registration;
pub use self::registration::Shift;
use self::sequence::Sequence;
use self::values::Values;
use crate::capture::{Capture, Said};

/// How sure a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Certainty {
    /// No correct input looks like this.
    Sure,
    /// A rare correct input looks like this.
    Suspect,
}

/// What a finding is about; whoever knows the caller's options tells from it which one mends it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// Depths are this many times too large.
    TooFar(f64),
    /// Depths are this many times too small.
    TooNear(f64),
    /// The camera is not that of the image; perhaps this one is.
    Camera(Option<Camera>),
    /// The numbers of the depth image are no depth.
    NotDepth,
    /// Depth has the resolution of 8 bits.
    EightBit,
    /// Everything is equally far.
    Constant,
    /// The colour image lies otherwise than the depth.
    Registration,
    /// The lens bends the image, which is not undone.
    Distortion,
    /// The camera is not held upright.
    Turned,
    /// The direction of gravity that was given is not that of any surface.
    Gravity,
    /// Frames are missing, repeated or out of order.
    Sequence,
    /// The input cannot be read.
    Unreadable,
}

impl Cause {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::TooFar(_) => "too_far",
            Self::TooNear(_) => "too_near",
            Self::Camera(_) => "camera",
            Self::NotDepth => "not_depth",
            Self::EightBit => "eight_bit",
            Self::Constant => "constant",
            Self::Registration => "registration",
            Self::Distortion => "distortion",
            Self::Turned => "turned",
            Self::Gravity => "gravity",
            Self::Sequence => "sequence",
            Self::Unreadable => "unreadable",
        }
    }
}

/// Something that may be wrong.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Finding {
    /// How sure it is.
    pub certainty: Certainty,
    /// What it is about.
    pub cause: Cause,
    /// What was seen and what it means, in a sentence.
    pub reason: String,
    /// Frames in which it was seen, of those that were looked at.
    pub frames: usize,
}

impl Finding {
    /// A finding of one frame, or of all together.
    pub fn new(certainty: Certainty, cause: Cause, reason: String) -> Self {
        Self { certainty, cause, reason, frames: 1 }
    }
}

/// What an input is, and what may be wrong with it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Report {
    /// What it is; `None` if no frame could be read.
    pub facts: Option<Facts>,
    /// What may be wrong, the surest first.
    pub findings: Vec<Finding>,
}

/// What an input is.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Facts {
    /// Frames that the input has.
    pub frames: usize,
    /// Those that were looked at.
    pub examined: usize,
    /// Frames in a second, by the stamps; `None` without stamps.
    pub rate_hz: Option<f64>,
    /// Columns and rows of the first frame (px).
    pub size_px: [usize; 2],
    /// Whether there is colour.
    pub has_color: bool,
    /// Units of stored depth that make a metre, where the input says it.
    pub depth_scale: Option<f64>,
    /// The depths (m) between which nine tenths of the pixels lie.
    pub range_m: [f64; 2],
    /// Share of the pixels that have depth.
    pub valid_share: f64,
    /// Bits that would be enough for the different depths of a frame.
    pub depth_bits: u32,
    /// The noise of single pixels and of waves, relative to a Kinect v1.
    pub noise: Option<[f64; 2]>,
    /// fx, fy, cx, cy (px).
    pub camera: [f64; 4],
    /// What the camera sees (degrees), across and down.
    pub field_of_view_deg: [f64; 2],
    /// How far the lens bends pixels at most (px), where the input says it.
    pub distortion_px: Option<f64>,
    /// How far the edges of the colour lie from those of the depth; `None` where they do not tell.
    pub registration: Option<Shift>,
    /// Height of the camera over the support plane (m), how far it looks down and how far it is rolled (degrees).
    pub mount: Option<Mount>,
    /// Frames in which it is not clear which surface is the ground.
    pub ground_in_doubt: usize,
    /// Frames whose depth is smeared at edges, which are made steps again.
    pub smeared: usize,
    /// Frames that have a grid of small holes, which are bridged.
    pub with_hole_grid: usize,
}

/// How the camera is mounted over the support plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mount {
    /// Distance of the camera from the plane (m).
    pub height_m: f64,
    /// How far it looks down: 0 at the horizon, 90 straight down (degrees).
    pub tilt_deg: f64,
    /// How far it is turned clockwise about its axis, from -180 to 180 (degrees).
    pub roll_deg: f64,
}

/// Looks at the frames of one input.
#[derive(Debug, Default)]
pub struct Examination {
    first: Option<First>,
    examined: usize,
    values: Values,
    registration: Registration,
    sequence: Sequence,
    noise: Vec<[f64; 2]>,
    mounts: Vec<Mount>,
    ground_in_doubt: usize,
    smeared: usize,
    with_hole_grid: usize,
    findings: Vec<Finding>,
}

/// What the first frame tells of all.
#[derive(Debug)]
struct First {
    size: (usize, usize),
    camera: Camera,
    has_color: bool,
    said: Said,
}

impl Examination {
    /// Looks at a frame, and at what was found in it. O(n) for n pixels.
    pub fn look(&mut self, capture: &Capture, found: &Discovery) {
        let frame = &capture.frame;
        self.first.get_or_insert(First {
            size: frame.size(),
            camera: frame.camera(),
            has_color: frame.color().is_some(),
            said: capture.said,
        });
        self.examined += 1;
        let mut doubts = certainty::of_doubts(&find_doubts(frame), frame);
        doubts.extend(self.values.look(frame));
        doubts.extend(found.notices.iter().filter_map(turned));
        doubts.extend(found.notices.iter().filter_map(missed));
        doubts.extend(bent(capture));
        doubts.into_iter().for_each(|doubt| self.note(doubt));
        self.registration.look(frame);
        self.sequence.look(frame, capture.stamp_ns);
        self.noise.extend(found.estimates.map(|estimates| [estimates.noise.white, estimates.noise.waves()]));
        self.mounts.extend(mount(found));
        let notes = |is_such: fn(&Notice) -> bool| usize::from(found.notices.iter().any(is_such));
        self.ground_in_doubt += notes(|notice| matches!(notice, Notice::GroundInDoubt { .. }));
        self.smeared += notes(|notice| matches!(notice, Notice::Smeared { .. }));
        self.with_hole_grid += notes(|notice| matches!(notice, Notice::HoleGrid { .. }));
    }

    /// Notes that a frame cannot be read, or anything else that the caller finds.
    pub fn note(&mut self, finding: Finding) {
        let is_same = |other: &&mut Finding| {
            std::mem::discriminant(&other.cause) == std::mem::discriminant(&finding.cause)
        };
        match self.findings.iter_mut().find(is_same) {
            Some(known) => known.frames += finding.frames,
            None => self.findings.push(finding),
        }
    }

    /// The report on an input whose frames have these names and stamps (ns), in their order.
    pub fn report(mut self, names: &[String], stamps_ns: &[Option<i64>]) -> Report {
        let together = self.sequence.findings(names, stamps_ns);
        let shift = self.registration.shift(self.first.as_ref().map_or(0, |first| first.size.0));
        let of_shift = shift.and_then(|shift| shift.finding());
        // Colour that is mirrored has its edges anywhere.
        let is_mirrored = self.findings.iter().any(|finding| matches!(finding.cause, Cause::Registration));
        together.into_iter().chain(of_shift.filter(|_| !is_mirrored)).for_each(|finding| self.note(finding));
        let kept = self.examined.div_ceil(3);
        self.findings.retain(|finding| finding.frames >= kept || is_of_all(finding));
        self.findings.sort_by_key(|finding| finding.certainty);
        let facts = self.facts(names.len(), stamps_ns, shift);
        Report { facts, findings: self.findings }
    }

    fn facts(&self, frames: usize, stamps_ns: &[Option<i64>], registration: Option<Shift>) -> Option<Facts> {
        let first = self.first.as_ref()?;
        let Camera { fx_px, fy_px, cx_px, cy_px } = first.camera;
        let (width, height) = first.size;
        let angle = |extent: usize, focal: f64| 2.0 * (extent as f64 / (2.0 * focal)).atan().to_degrees();
        Some(Facts {
            frames,
            examined: self.examined,
            rate_hz: sequence::rate_hz(stamps_ns),
            size_px: [width, height],
            has_color: first.has_color,
            depth_scale: first.said.depth_scale,
            range_m: self.values.range_m(),
            valid_share: self.values.valid_share(),
            depth_bits: self.values.bits(),
            noise: middle(&self.noise, |noise| noise[1]),
            camera: [fx_px, fy_px, cx_px, cy_px],
            field_of_view_deg: [angle(width, fx_px), angle(height, fy_px)],
            distortion_px: first.said.distortion_px,
            registration,
            mount: middle(&self.mounts, |mount| mount.tilt_deg),
            ground_in_doubt: self.ground_in_doubt,
            smeared: self.smeared,
            with_hole_grid: self.with_hole_grid,
        })
    }
}

/// Whether a finding is about the input and not about single frames.
fn is_of_all(finding: &Finding) -> bool {
    matches!(finding.cause, Cause::Sequence | Cause::Registration | Cause::Unreadable)
}

/// A camera was given to images whose lens bends them. Without it the distortion is undone.
fn bent(capture: &Capture) -> Option<Finding> {
    let bent_px = capture.said.distortion_px.filter(|&px| px > MUCH_BENT_PX)?;
    let is_given = capture.said.camera.is_some_and(|own| own.camera != capture.frame.camera());
    let reason = format!(
        "by the recording its lens bends pixels by up to {bent_px:.0} px, but images of a camera that is given are taken as without distortion"
    );
    is_given.then(|| Finding::new(Certainty::Suspect, Cause::Distortion, reason))
}

/// No surface faces up as it was given.
fn missed(notice: &Notice) -> Option<Finding> {
    let is_missed = matches!(notice, Notice::GravityMissed { .. });
    is_missed.then(|| Finding::new(Certainty::Suspect, Cause::Gravity, notice.to_string()))
}

/// What the way the camera is held suggests.
fn turned(notice: &Notice) -> Option<Finding> {
    let Notice::Turned { degrees } = notice else { return None };
    let reason = format!(
        "the plane on which most things stand shows that the camera is turned clockwise by about {degrees} degrees: is it mounted so, or are the images turned?"
    );
    Some(Finding::new(Certainty::Suspect, Cause::Turned, reason))
}

/// How the camera is held over the plane that faces up best.
fn mount(found: &Discovery) -> Option<Mount> {
    let up = found.up.direction.map(f64::from);
    let along = |normal: [f32; 3]| -> f64 { normal.iter().zip(up).map(|(&n, u)| f64::from(n) * u).sum() };
    let level = found.structure_planes.iter().filter(|plane| along(plane.normal) > LEVEL_COS);
    let support = level.max_by(|a, b| a.inlier_share.total_cmp(&b.inlier_share))?;
    let [x, y, z] = up;
    Some(Mount {
        height_m: support.offset_m.into(),
        tilt_deg: (-z).clamp(-1.0, 1.0).asin().to_degrees(),
        roll_deg: (-x).atan2(-y).to_degrees(),
    })
}

/// Distortion that matters (px): edges of depth are that uncertain.
const MUCH_BENT_PX: f64 = 2.0;

/// A plane carries if its normal is within 20 degrees of up.
const LEVEL_COS: f64 = 0.94;

/// The element whose key is in the middle.
fn middle<T: Copy>(all: &[T], key: impl Fn(&T) -> f64) -> Option<T> {
    let mut sorted = all.to_vec();
    sorted.sort_by(|a, b| key(a).total_cmp(&key(b)));
    sorted.get(sorted.len() / 2).copied()
}
