//! Estimates the camera's own motion from what stands still.

use glam::DVec3;
use objecthood::Camera;
use serde::{Deserialize, Serialize};

use crate::align::{Motion, SurfacePoint, align, fit, gain, open_fit, promised_gain};
use crate::bits::Bits;
use crate::rigid::Rigid;
use crate::turn::SmallImage;
use crate::view::View;

/// The cells of a grid, of each of which one point is followed: width and height (px at VGA size).
const GRID_PX: [f64; 2] = [16.0, 12.0];
/// If fewer points lie off the planes of structure, four times as many are taken there: a quarter of the grid tells
/// enough.
const LEAST_OFF_PLANES: usize = 400;
/// In a cell, every second column and row is looked at (px).
const STRIDE_PX: usize = 2;
/// Print, edges and shadows change grey values by at least this (levels per pixel at VGA size), over this many
/// pixels to each side (px at VGA size). Noise of 3 levels changes them by 0.7, shine by less.
const LEAST_CHANGE: f64 = 3.0;
const CHANGE_PX: f64 = 3.0;
/// A smaller step counts as standing still: shift (m), turn (rad).
const STILL: (f64, f64) = (0.0005, 0.0005);
/// A new key frame is taken if fewer points are in view or fit.
const LEAST_SEEN: f64 = 0.75;
const LEAST_FIT: f64 = 0.5;
/// The motion is unknown if fewer points fit.
const LOST_FIT: f64 = 0.3;
/// The camera moves if a motion explains the frame better than standing still does, by this mean square of
/// standard deviations. A hand and its shadow hide much of the key frame. A slow motion is found once it has
/// summed up to this: about a millimetre at a metre.
const LEAST_GAIN: f64 = 0.1;
/// If the search promised little, the motion has to gain more: along an even table, a search that started
/// elsewhere gained 0.13 by noise alone.
const LEAST_GAIN_FAR: f64 = 0.5;
/// A motion is searched for if the next step of a search promises this. (Of a camera that stands, frames of
/// another simulator promised 0.03 at most, while hands and things moved.)
const LEAST_PROMISE: f64 = 0.04;

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

    /// Estimates where the camera is in a frame. `agents`: where agents were seen in the last frame; their
    /// motions are not the camera's. `up`: the direction up by this frame, in its camera. O(n).
    pub(crate) fn follow(&mut self, view: &View, agents: &Bits, given: Option<Rigid>, up: DVec3) -> Place {
        // An agent that is nearly everywhere is one because the motion of the camera was missed.
        let is_everywhere = 2 * agents.count() > view.size.0 * view.size.1;
        let agents = if is_everywhere { &Bits::none(view.size) } else { agents };
        let is_first = self.key.is_empty() && self.up.is_none();
        // A given pose needs no guess.
        let now = if given.is_none() { SmallImage::of(view) } else { None };
        let last = std::mem::replace(&mut self.last, now);
        let found = match given {
            _ if is_first => Some(Step::NONE),
            Some(pose) => Some(Step { rigid: pose.inverse().after(&self.world_from_camera), ..Step::NONE }),
            None => self.step(view, agents, last.as_ref()),
        };
        let is_lost = found.is_none();
        let Step { rigid: step, covariance } = found.unwrap_or(Step::NONE);
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
        let (fits, seen) = fit(&self.open_points(view, agents), view, &self.from_key);
        if seen < LEAST_SEEN || fits < LEAST_FIT || is_lost {
            self.key = grid(view, agents);
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

    /// The points of the key frame that now lie on no agent.
    fn open_points(&self, view: &View, agents: &Bits) -> Vec<SurfacePoint> {
        let is_open = |point: &&SurfacePoint| {
            let pixel = view.pixel_of(self.from_key.point(point.at));
            !pixel.is_some_and(|pixel| agents.has(pixel))
        };
        self.key.iter().filter(is_open).copied().collect()
    }

    /// The step since the last frame; `None` if it cannot be found.
    fn step(&self, view: &View, agents: &Bits, last: Option<&SmallImage>) -> Option<Step> {
        let points = self.open_points(view, agents);
        let turn = last.zip(self.last.as_ref()).and_then(|(last, now)| last.turn_to(now));
        let turn = turn.filter(|turn| turn.angle_rad() * view.camera.fx_px > GUESSED_PX);
        let promises_little = promised_gain(&points, view, &self.from_key) < LEAST_PROMISE;
        if turn.is_none() && promises_little && fit(&points, view, &self.from_key).0 > LEAST_FIT {
            return Some(Step::NONE);
        }
        let Some(motion) = self.align(&points, view, turn) else {
            // What agents hide is no sign of a lost camera.
            return (2 * points.len() < self.key.len()).then_some(Step::NONE);
        };
        let gain = gain(&points, view, &motion.rigid, &self.from_key);
        let least = if promises_little { LEAST_GAIN_FAR } else { LEAST_GAIN };
        if gain.is_some_and(|gain| gain < least) {
            return Some(Step::NONE);
        }
        let rigid = motion.rigid.after(&self.from_key.inverse());
        Some(Step { rigid, covariance: motion.covariance })
    }

    /// The motion since the key frame. The search starts where the camera was, and where a guessed turn has
    /// brought it. The result is the one by which more points lie where they lay, and the second if they are
    /// alike. `None` if neither fits.
    fn align(&self, points: &[SurfacePoint], view: &View, turn: Option<Rigid>) -> Option<Motion> {
        // What stands before the scene, such as a person, says nothing about the camera.
        let fits = |guess: Rigid| {
            let motion = align(points, view, &guess)?;
            Some((open_fit(points, view, &motion.rigid), motion)).filter(|(fit, _)| *fit > LOST_FIT)
        };
        let turned = turn.and_then(|turn| fits(turn.after(&self.from_key)));
        let still = fits(self.from_key);
        let best = match (still, turned) {
            (Some(still), Some(turned)) if turned.0 > still.0 - ALIKE_FIT => Some(turned),
            (still, turned) => still.or(turned),
        };
        best.map(|(_, motion)| motion)
    }
}

/// A step of the camera.
struct Step {
    /// Maps points of the last frame's camera to this frame's.
    rigid: Rigid,
    covariance: [[f64; 6]; 6],
}

impl Step {
    const NONE: Self = Self { rigid: Rigid::IDENTITY, covariance: [[0.0; 6]; 6] };
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

/// Points of a frame: one of every cell of a grid. Planes of structure say nothing of motions along them; what
/// stands on them does. If only few points lie off the planes, there is one of every quarter of a cell. None lies
/// on an agent. O(n).
fn grid(view: &View, agents: &Bits) -> Vec<SurfacePoint> {
    let cell = GRID_PX.map(|px| view.length_px(px));
    let points = |cell: [usize; 2], off_planes: bool| -> Vec<SurfacePoint> {
        let (columns, rows) = (view.size.0.div_ceil(cell[0]), view.size.1.div_ceil(cell[1]));
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        let pixels = cells.map(|[column, row]| pixel_of(view, [column * cell[0], row * cell[1]], cell));
        let is_one =
            |&(pixel, _): &(usize, bool)| view.is_structure(pixel) != off_planes && !agents.has(pixel);
        let point = |(pixel, is_clear): (usize, bool)| {
            let grey = view.grey.get(pixel).filter(|_| is_clear).map(|&grey| f64::from(grey));
            Some(SurfacePoint { at: view.point(pixel)?, grey })
        };
        pixels.filter(is_one).filter_map(point).collect()
    };
    let off_planes = points(cell, true);
    let off_planes = match off_planes.len() < LEAST_OFF_PLANES {
        true => points(cell.map(|px| px.div_ceil(2)), true),
        false => off_planes,
    };
    [points(cell, false), off_planes].concat()
}

/// The pixel of a cell, which begins at a column and row, at which grey values change most within a surface, and
/// whether they change clearly. Else it is the middle of the cell, whose grey value tells nothing: of even surfaces
/// only light and shine change.
fn pixel_of(view: &View, [left, top]: [usize; 2], [width, height]: [usize; 2]) -> (usize, bool) {
    let (right, bottom) = ((left + width).min(view.size.0), (top + height).min(view.size.1));
    let (reach, least) = (view.length_px(CHANGE_PX), LEAST_CHANGE * 640.0 / view.size.0 as f64);
    let pixels = (top..bottom).step_by(STRIDE_PX);
    let pixels = pixels.flat_map(|v| (left..right).step_by(STRIDE_PX).map(move |u| (u, v)));
    let change = |(u, v)| Some((view.change_within_surface(u, v, reach)?, v * view.size.0 + u));
    let best = pixels.filter_map(change).max_by(|a, b| a.0.total_cmp(&b.0));
    let middle = (top + bottom) / 2 * view.size.0 + (left + right) / 2;
    best.filter(|&(square, _)| square >= least * least).map_or((middle, false), |(_, pixel)| (pixel, true))
}

#[cfg(test)]
mod tests {
    use glam::DMat3;
    use objecthood::discovery::StructurePlane;
    use objecthood::{Discovery, Frame, Raster};

    use super::*;

    const SIZE: (usize, usize) = (320, 240);
    const BALL_M: f64 = 0.06;
    const BALLS: [[f64; 2]; 9] = [
        [0.2, 0.1],
        [-0.2, 0.05],
        [0.05, -0.2],
        [-0.1, 0.25],
        [0.1, 0.35],
        [0.0, 0.02],
        [0.3, -0.1],
        [-0.32, -0.08],
        [-0.3, 0.3],
    ];

    /// Balls on an even table, as a camera sees them that has gone round them by this angle. A highlight goes with
    /// the camera, as that of a shining table does.
    fn seen(angle_rad: f64, number: u64) -> View {
        let (sin, cos) = angle_rad.sin_cos();
        let back = DVec3::new(0.6 * sin, -0.6 * cos, 0.8);
        let right = DVec3::new(cos, sin, 0.0);
        let world_from_camera = DMat3::from_cols(right, right.cross(back), -back);
        let camera = Camera::new(262.0, 262.0, 159.5, 119.5).unwrap();
        let mut noise = number.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut measure = |z_m: f64| {
            // A sum of uniform numbers, of the standard deviation of a Kinect.
            let mut sum = -6.0;
            for _ in 0..12 {
                noise ^= noise << 13;
                noise ^= noise >> 7;
                noise ^= noise << 17;
                sum += (noise >> 11) as f64 / (1_u64 << 53) as f64;
            }
            (z_m + 0.0012 * z_m * z_m * sum) as f32
        };
        let (mut depth_m, mut color, mut structure) = (Vec::new(), Vec::new(), Vec::new());
        for pixel in 0..SIZE.0 * SIZE.1 {
            let (u, v) = ((pixel % SIZE.0) as f64, (pixel / SIZE.0) as f64);
            let (from, ray) = (1.2 * back, world_from_camera * DVec3::from(camera.ray(u, v)));
            let to_table = -from.z / ray.z;
            let to_ball = |[x, y]: [f64; 2]| {
                let beside = from - DVec3::new(x, y, BALL_M);
                let (half, square) = (beside.dot(ray), ray.length_squared());
                let inside = half * half - square * (beside.length_squared() - BALL_M * BALL_M);
                (inside > 0.0).then(|| (-half - inside.sqrt()) / square)
            };
            let nearest = BALLS.into_iter().filter_map(to_ball).min_by(f64::total_cmp);
            let shine = 90.0 * (-((u - 200.0).powi(2) + (v - 80.0).powi(2)) / 6000.0).exp();
            depth_m.push(measure(nearest.unwrap_or(to_table)));
            color.push(if nearest.is_some() { [200, 60, 40] } else { [90 + shine as u8; 3] });
            structure.push(u16::from(nearest.is_none()));
        }
        let raster = |values| Raster::from_vec(SIZE.0, SIZE.1, values).unwrap();
        let mut found = Discovery::new(Vec::new(), Raster::filled(SIZE.0, SIZE.1, 0).unwrap());
        found.structure = raster(structure);
        let normal = (world_from_camera.transpose() * DVec3::Z).as_vec3().to_array();
        found.structure_planes = vec![StructurePlane { normal, offset_m: 0.96, inlier_share: 0.9 }];
        let depth_m = Raster::from_vec(SIZE.0, SIZE.1, depth_m).unwrap();
        let color = Raster::from_vec(SIZE.0, SIZE.1, color).unwrap();
        View::of(&Frame::new(depth_m, Some(color), camera).unwrap(), 1.0).with_planes(&found)
    }

    /// A regression, after the clips `orbit71` to `orbit73` of another simulator: a camera that went round a table by 34 degrees had turned by 12 for
    /// the tracker. Almost all points lie on the table, which says nothing of a motion along it; its noise and its
    /// highlights said that the camera stood.
    #[test]
    fn a_camera_that_goes_round_a_table_is_followed() {
        let mut motion = CameraMotion::new();
        for number in 0..40_u32 {
            let angle_rad = 0.01 * f64::from(number);
            let place =
                motion.follow(&seen(angle_rad, u64::from(number) + 1), &Bits::none(SIZE), None, DVec3::NEG_Y);
            let turned_rad = place.world_from_camera.angle_rad();
            assert!((turned_rad - angle_rad).abs() < 0.035, "{turned_rad} instead of {angle_rad} rad");
            assert!(!place.is_lost);
        }
    }

    #[test]
    fn a_camera_that_stands_does_not_move() {
        let mut motion = CameraMotion::new();
        for number in 1..20 {
            let place = motion.follow(&seen(0.0, number), &Bits::none(SIZE), None, DVec3::NEG_Y);
            assert!(!place.moves, "frame {number}");
        }
    }

    #[test]
    fn what_agents_hide_does_not_hide_the_motion_of_the_camera() {
        for share in [0.3, 0.8] {
            let agents = Bits::of(SIZE, |pixel| ((pixel % SIZE.0) as f64) < share * SIZE.0 as f64);
            let mut motion = CameraMotion::new();
            let follow = |motion: &mut CameraMotion, number: u32| {
                let angle_rad = 0.01 * f64::from(number);
                motion.follow(&seen(angle_rad, u64::from(number) + 1), &agents, None, DVec3::NEG_Y)
            };
            let turned_rad = (0..20).map(|number| follow(&mut motion, number).world_from_camera.angle_rad());
            let last_rad = turned_rad.last().unwrap();
            assert!((last_rad - 0.19).abs() < 0.06, "{last_rad} rad, agents over {share}");
        }
    }

    #[test]
    fn a_camera_is_not_lost_because_agents_hide_the_scene() {
        let follow = |motion: &mut CameraMotion, view: &View, agents: &Bits| {
            motion.follow(view, agents, None, DVec3::NEG_Y).is_lost
        };
        // What is seen elsewhere is far from what was there.
        let [before, after] = [seen(0.0, 1), seen(2.0, 2)];
        let half = Bits::of(SIZE, |pixel| pixel % SIZE.0 < SIZE.0 / 2);
        let mut motion = CameraMotion::new();
        assert!(!follow(&mut motion, &before, &Bits::none(SIZE)));
        motion.key.retain(|point| point.at.x < 0.0 || point.at.x > 0.25);
        assert!(!follow(&mut motion, &after, &half));
    }

    #[test]
    fn points_are_found_in_images_without_colour_and_lower_than_a_cell() {
        let camera = Camera::new(525.0, 525.0, 319.5, 3.5).unwrap();
        let depth_m = Raster::filled(640, 8, 1.0).unwrap();
        let view = View::of(&Frame::new(depth_m, None, camera).unwrap(), 1.0);
        let points = grid(&view, &Bits::none((640, 8)));
        assert!(points.len() >= 40 && points.iter().all(|point| point.grey.is_none()));
    }
}
