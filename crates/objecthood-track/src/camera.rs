//! Estimates the camera's own motion from what stands still.

use glam::DVec3;
use objecthood::Camera;
use serde::{Deserialize, Serialize};

use crate::align::{Motion, SurfacePoint, align, fit, gain, open_fit};
use crate::rigid::Rigid;
use crate::turn::SmallImage;
use crate::view::View;

/// Points lie on a grid with this distance of columns and rows (px at VGA size).
const GRID_PX: [f64; 2] = [16.0, 12.0];
/// A smaller step counts as standing still: shift (m), turn (rad).
const STILL: (f64, f64) = (0.0005, 0.0005);
/// A new key frame is taken if fewer points are in view or fit.
const LEAST_SEEN: f64 = 0.75;
const LEAST_FIT: f64 = 0.5;
/// The motion is unknown if fewer points fit.
const LOST_FIT: f64 = 0.3;
/// If this share of the points of the key frame lie where they lay, the camera stands still.
const STANDS_FIT: f64 = 0.85;
/// The camera moves if a motion explains the frame better than standing still does, by this mean square of
/// standard deviations. A hand and its shadow hide much of the key frame. A slow motion is found once it has
/// summed up to this: about a millimetre at a metre.
const LEAST_GAIN: f64 = 0.1;

/// A turn by less than this (px) is found without a guess.
const GUESSED_PX: f64 = 4.0;
/// After a turn by more than this (px) in one frame, remembered and seen pixels no longer match: the frame is
/// blurred, and depth and colour are of different times.
const FAST_PX: f64 = 8.0;
/// Starting from the guess is right if the share of points that lie where they lay is lower by at most this:
/// in a blurred frame an alignment that stops on the way fits as well.
const ALIKE_FIT: f64 = 0.05;

/// Other intrinsics count if they move a pixel by more than this (px): those of organized clouds are fitted,
/// and vary a little.
const OTHER_CAMERA_PX: f64 = 0.5;

/// The place of the camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// Maps points of the camera to the world, which is the first frame's camera or that of the given poses.
    pub(crate) world_from_camera: Rigid,
    /// Maps points of the last frame's camera to this frame's.
    pub(crate) step: Rigid,
    /// The intrinsics with which the remembered pixels were seen.
    pub(crate) remembered: Camera,
    /// The direction against gravity, in the world.
    pub(crate) up: DVec3,
    /// Whether the camera is moving, or zooming.
    pub(crate) moves: bool,
    /// Whether it turned so fast that the error of the motion exceeds noise.
    pub(crate) is_fast: bool,
    /// Whether the motion could not be found.
    pub(crate) is_lost: bool,
    /// Covariance of the step: shift (m), turn (rad).
    pub(crate) covariance: [[f64; 6]; 6],
}

impl Place {
    pub(crate) fn world(&self, p: DVec3) -> DVec3 {
        self.world_from_camera.point(p)
    }

    /// Height (m) of a point of the camera above the origin of the world.
    pub(crate) fn height_m(&self, p: DVec3) -> f64 {
        self.world(p).dot(self.up)
    }
}

/// Follows the camera from frame to frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct CameraMotion {
    key: Vec<SurfacePoint>,
    /// Maps points of the key frame's camera to the last frame's.
    from_key: Rigid,
    world_from_camera: Rigid,
    up: Option<DVec3>,
    /// Intrinsics of the frame from which the remembered pixels are.
    intrinsics: Option<Camera>,
    /// The last frame, for guessing a turn.
    last: Option<SmallImage>,
}

impl CameraMotion {
    pub(crate) fn new() -> Self {
        Self {
            key: Vec::new(),
            from_key: Rigid::IDENTITY,
            world_from_camera: Rigid::IDENTITY,
            up: None,
            intrinsics: None,
            last: None,
        }
    }

    /// Estimates where the camera is in a frame. `up`: the direction up by this frame, in its camera. O(n /
    /// grid).
    pub(crate) fn follow(&mut self, view: &View, given: Option<Rigid>, up: DVec3) -> Place {
        let is_first = self.key.is_empty() && self.up.is_none();
        // A given pose needs no guess.
        let now = if given.is_none() { SmallImage::of(view) } else { None };
        let last = std::mem::replace(&mut self.last, now);
        let mut covariance = [[0.0; 6]; 6];
        let mut is_lost = false;
        let step = if is_first {
            Rigid::IDENTITY
        } else if let Some(pose) = given {
            pose.inverse().after(&self.world_from_camera)
        } else if fit(&self.key, view, &self.from_key).0 > STANDS_FIT {
            Rigid::IDENTITY
        } else {
            let turn = last.zip(self.last.as_ref()).and_then(|(last, now)| last.turn_to(now));
            match self.align(view, turn) {
                Some(motion) => {
                    let gain = gain(&self.key, view, &motion.rigid, &self.from_key);
                    if gain.is_some_and(|gain| gain < LEAST_GAIN) {
                        Rigid::IDENTITY
                    } else {
                        covariance = motion.covariance;
                        self.settle(&motion)
                    }
                }
                None => {
                    is_lost = true;
                    Rigid::IDENTITY
                }
            }
        };
        let is_still = step == Rigid::IDENTITY || is_still(&step);
        let step = if is_still { Rigid::IDENTITY } else { step };
        let remembered = self.intrinsics.unwrap_or(view.camera);
        let is_fast = given.is_none() && step.angle_rad() * view.camera.fx_px > FAST_PX;
        let moves = !is_still || shift_px(&remembered, view) > OTHER_CAMERA_PX;
        if moves || is_first {
            self.intrinsics = Some(view.camera);
        }
        // A given pose that differs by less than noise is not adopted. So the steps of a slow motion sum up
        // until they are followed.
        self.world_from_camera = match given {
            Some(pose) if is_first || !is_still => pose,
            _ => self.world_from_camera.after(&step.inverse()),
        };
        self.from_key = step.after(&self.from_key);
        let (fits, seen) = fit(&self.key, view, &self.from_key);
        if seen < LEAST_SEEN || fits < LEAST_FIT || is_lost {
            self.key = grid(view);
            self.from_key = Rigid::IDENTITY;
        }
        let told = self.world_from_camera.direction(up);
        let up = self.up.map_or(told, |mean| (mean + 0.1 * (told - mean)).normalize_or(told));
        self.up = Some(up);
        Place {
            world_from_camera: self.world_from_camera,
            step,
            remembered,
            up,
            moves,
            is_fast,
            is_lost,
            covariance,
        }
    }

    /// The motion since the key frame. The search starts where the camera was, and where a guessed turn has
    /// brought it. The result is the one by which more points lie where they lay, and the second if they are
    /// alike. `None` if neither fits.
    fn align(&self, view: &View, turn: Option<Rigid>) -> Option<Motion> {
        // What stands before the scene, such as a person, says nothing about the camera.
        let fits = |guess: Rigid| {
            let motion = align(&self.key, view, &guess)?;
            Some((open_fit(&self.key, view, &motion.rigid), motion)).filter(|(fit, _)| *fit > LOST_FIT)
        };
        let is_far = |turn: &Rigid| turn.angle_rad() * view.camera.fx_px > GUESSED_PX;
        let turned = turn.filter(is_far).and_then(|turn| fits(turn.after(&self.from_key)));
        let still = fits(self.from_key);
        let best = match (still, turned) {
            (Some(still), Some(turned)) if turned.0 > still.0 - ALIKE_FIT => Some(turned),
            (still, turned) => still.or(turned),
        };
        best.map(|(_, motion)| motion)
    }

    fn settle(&self, motion: &Motion) -> Rigid {
        motion.rigid.after(&self.from_key.inverse())
    }
}

/// Whether a step is within noise, measured at 1 m in front of the camera.
fn is_still(step: &Rigid) -> bool {
    step.displacement_m(DVec3::Z) < STILL.0 && step.angle_rad() < STILL.1
}

/// How far other intrinsics move what is seen at the corners of the image (px).
fn shift_px(before: &Camera, view: &View) -> f64 {
    let (right, bottom) = (view.size.0 as f64 - 1.0, view.size.1 as f64 - 1.0);
    let shift = |(u, v): (f64, f64)| {
        let now = view.camera.project(before.ray(u, v).map(|part| part as f32));
        (now.0 - u).abs().max((now.1 - v).abs())
    };
    [(0.0, 0.0), (right, bottom)].map(shift).into_iter().fold(0.0, f64::max)
}

/// Points of a frame on a grid.
fn grid(view: &View) -> Vec<SurfacePoint> {
    let [columns, rows] = GRID_PX.map(|px| view.length_px(px));
    let (width, height) = view.size;
    let pixels = (rows / 2..height)
        .step_by(rows)
        .flat_map(|v| (columns / 2..width).step_by(columns).map(move |u| v * width + u));
    pixels
        .filter_map(|pixel| {
            let at = view.point(pixel)?;
            Some(SurfacePoint { at, grey: view.grey.get(pixel).map(|&grey| f64::from(grey)) })
        })
        .collect()
}
