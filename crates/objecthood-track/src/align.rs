//! Rigid motion of a set of surface points from one frame to the next: robust, point to plane and grey value.
//!
//! Gauss-Newton with Huber weights, projective data association (G. Blais, M. Levine, PAMI 17(8), 1995), after the design
//! note: 8 iterations, of which the first two only translate. Serves camera and objects alike. O(points).

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::rigid::Rigid;
use crate::view::View;

/// A point of a surface.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct SurfacePoint {
    /// Its old place (m), in the frame of the camera.
    pub(crate) at: DVec3,
    /// Its old grey value, 0 to 255; `None` without colour.
    pub(crate) grey: Option<f64>,
}

/// How something moved.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Motion {
    /// Maps old places to new ones, in the frame of the camera.
    pub(crate) rigid: Rigid,
    /// Covariance of shift (m) and turn (rad) about the centre of the points: shift first.
    pub(crate) covariance: [[f64; 6]; 6],
    /// Share of the points in view that lie at their new place and look as they did.
    pub(crate) fit: f64,
}

const ITERATIONS: usize = 8;
/// Iterations that only translate.
const SHIFTS: usize = 2;
/// With fewer points no rotation is estimated.
const LEAST_FOR_TURNS: usize = 150;
/// With fewer points no motion is estimated.
const LEAST_POINTS: usize = 30;
/// Standard deviation of grey values (levels).
const SIGMA_GREY: f64 = 8.0;
/// Beyond this many standard deviations a residual counts linearly.
const HUBER: f64 = 1.5;
/// Beyond this many a residual does not count: depth, grey.
const CUT: [f64; 2] = [12.0, 8.0];
/// A point beyond this depth difference (m) is somewhere else than expected: in the first iterations, and
/// from the fifth on.
const FAR_M: [f64; 2] = [0.05, 0.025];
/// A point fits within the first number of standard deviations of depth, and the second of grey.
const FIT: [f64; 2] = [3.5, 8.0];
/// Beyond this many standard deviations a residual counts no more when two motions are compared: a few points in
/// the shadow of something that passes tell nothing.
const GAIN_CUT: f64 = 3.5;
/// Something stands before a point if it is nearer by this (m).
const COVERED_M: f64 = 0.02;
/// Weak prior for no motion: inverse variances of shift (1/m²) and turn (1/rad²).
const PRIOR: [f64; 2] = [1e2, 1.0];

/// Estimates the motion of points into a view, starting from a guess. `None` if too few of them can be found
/// there.
pub(crate) fn align(points: &[SurfacePoint], view: &View, guess: &Rigid) -> Option<Motion> {
    if points.len() < LEAST_POINTS {
        return None;
    }
    let center = points.iter().map(|point| point.at).sum::<DVec3>() / points.len() as f64;
    let mut rigid = *guess;
    let mut system = System::default();
    for iteration in 0..ITERATIONS {
        let far_m = FAR_M[usize::from(iteration >= 4)];
        let middle = rigid.point(center);
        system = System::default();
        for point in points {
            system.add(point, view, &rigid, middle, far_m);
        }
        if system.used < LEAST_POINTS {
            return None;
        }
        let turns = iteration >= SHIFTS && points.len() >= LEAST_FOR_TURNS;
        let step = system.solve(if turns { 6 } else { 3 })?;
        let [shift, turn] = [DVec3::from_slice(&step[..3]), DVec3::from_slice(&step[3..])];
        rigid = Rigid::step(turn, shift, middle).after(&rigid);
        if iteration > SHIFTS && shift.length() < 1e-5 && turn.length() < 1e-5 {
            break;
        }
    }
    let (fit, _) = fit(points, view, &rigid);
    Some(Motion { rigid, covariance: system.covariance(), fit })
}

/// Two shares of the points: those that fit among those in view, and those in view.
pub(crate) fn fit(points: &[SurfacePoint], view: &View, rigid: &Rigid) -> (f64, f64) {
    let (mut in_view, mut fitting) = (0_usize, 0_usize);
    for point in points {
        let now = rigid.point(point.at);
        let Some(residual) = residual(point, now, view) else { continue };
        in_view += 1;
        fitting += usize::from(residual.fits(now.z, view));
    }
    (fitting as f64 / in_view.max(1) as f64, in_view as f64 / points.len().max(1) as f64)
}

/// The share of points that fit, among those in view that nothing nearer hides. 0 if these are too few.
pub(crate) fn open_fit(points: &[SurfacePoint], view: &View, rigid: &Rigid) -> f64 {
    let (mut open, mut fitting) = (0_usize, 0_usize);
    for point in points {
        let now = rigid.point(point.at);
        let Some(residual) = residual(point, now, view).filter(|residual| residual.depth > -COVERED_M) else {
            continue;
        };
        open += 1;
        fitting += usize::from(residual.fits(now.z, view));
    }
    if open < LEAST_POINTS { 0.0 } else { fitting as f64 / open as f64 }
}

/// By how much better one motion explains what is seen than another one (such as rest) does. It is the
/// difference of their mean squared residuals, in standard deviations, each cut off at [`GAIN_CUT`]. A point
/// that the first motion takes out of view counts as cut off. Points before which, by the other motion, something
/// nearer stands now are left out; `None` if too few remain.
pub(crate) fn gain(points: &[SurfacePoint], view: &View, rigid: &Rigid, other: &Rigid) -> Option<f64> {
    let (mut open, mut gain) = (0_usize, 0.0);
    for point in points {
        let z = point.at.z;
        let Some(by_other) = residual(point, other.point(point.at), view) else { continue };
        if by_other.depth < -COVERED_M {
            continue;
        }
        open += 1;
        let by_this = residual(point, rigid.point(point.at), view);
        let most = GAIN_CUT.powi(2) * if point.grey.is_some() { 2.0 } else { 1.0 };
        gain += by_other.square(z, view) - by_this.map_or(most, |residual| residual.square(z, view));
    }
    (open >= LEAST_POINTS).then(|| gain / open as f64)
}

/// By how much better than one motion the next Gauss-Newton step promises to explain what is seen: the decrease of
/// the mean square of residuals, in standard deviations; 0 if too few points can be found there. One pass over the
/// points.
pub(crate) fn promised_gain(points: &[SurfacePoint], view: &View, rigid: &Rigid) -> f64 {
    let center = points.iter().map(|point| point.at).sum::<DVec3>() / points.len().max(1) as f64;
    let middle = rigid.point(center);
    let mut system = System::default();
    points.iter().for_each(|point| system.add(point, view, rigid, middle, FAR_M[0]));
    match system.solve(6) {
        Some(step) if system.used >= LEAST_POINTS => {
            let less: f64 = step.iter().zip(system.g).map(|(step, slope)| -step * slope).sum();
            // Noise alone promises 1 for each unknown.
            (less - 6.0) / system.used as f64
        }
        _ => 0.0,
    }
}

/// What is seen at a point minus what was remembered: depth (m), grey value (levels; 0 without colour).
struct Residual {
    depth: f64,
    grey: f64,
}

impl Residual {
    /// Whether the residual is within noise.
    fn fits(&self, z: f64, view: &View) -> bool {
        self.depth.abs() < FIT[0] * view.sigma_m(z) && self.grey.abs() < FIT[1] * SIGMA_GREY
    }

    fn square(&self, z: f64, view: &View) -> f64 {
        (self.depth / view.sigma_m(z)).abs().min(GAIN_CUT).powi(2)
            + (self.grey / SIGMA_GREY).abs().min(GAIN_CUT).powi(2)
    }
}

/// The residual of a point that would now be at `now`; `None` out of view and where no depth was measured.
fn residual(point: &SurfacePoint, now: DVec3, view: &View) -> Option<Residual> {
    let pixel = view.pixel_of(now)?;
    let inverse = f64::from(view.inverse[pixel]);
    let depth = (inverse > 0.0).then(|| 1.0 / inverse - now.z)?;
    let grey = point.grey.zip(view.grey.get(pixel)).map_or(0.0, |(was, &is)| f64::from(is) - was);
    Some(Residual { depth, grey })
}

/// Normal equations: 3 shifts, then 3 turns.
#[derive(Default)]
struct System {
    h: [[f64; 6]; 6],
    g: [f64; 6],
    used: usize,
}

impl System {
    fn add(&mut self, point: &SurfacePoint, view: &View, rigid: &Rigid, middle: DVec3, far_m: f64) {
        let now = rigid.point(point.at);
        let Some((u, v)) = view.project(now) else { return };
        let pixel = (v + 0.5) as usize * view.size.0 + (u + 0.5) as usize;
        let Some(there) = view.point(pixel) else { return };
        if (there.z - now.z).abs() > far_m {
            return;
        }
        let arm = now - middle;
        if let Some(normal) = view.normal(pixel) {
            let residual = normal.dot(now - there);
            self.row(normal, arm, residual, view.sigma_m(now.z), CUT[0]);
            self.used += 1;
        }
        if let (Some(was), Some((is, along, down))) = (point.grey, view.grey_at(u, v)) {
            let (fx, fy) = (view.camera.fx_px / now.z, view.camera.fy_px / now.z);
            let slope = DVec3::new(along * fx, down * fy, -(along * fx * now.x + down * fy * now.y) / now.z);
            self.row(slope, arm, is - was, SIGMA_GREY, CUT[1]);
        }
    }

    /// Adds a residual with its derivative by a shift; a turn shifts by turn x arm.
    fn row(&mut self, slope: DVec3, arm: DVec3, residual: f64, sigma: f64, cut: f64) {
        let size = residual.abs() / sigma;
        if size > cut {
            return;
        }
        let weight = (HUBER / size.max(HUBER)) / (sigma * sigma);
        let turn = arm.cross(slope);
        let j = [slope.x, slope.y, slope.z, turn.x, turn.y, turn.z];
        for a in 0..6 {
            self.g[a] += weight * j[a] * residual;
            for b in 0..=a {
                self.h[a][b] += weight * j[a] * j[b];
            }
        }
    }

    fn with_prior(&self) -> [[f64; 6]; 6] {
        let mut h = self.h;
        for a in 0..6 {
            h[a][a] += PRIOR[a / 3];
            let lower = h[a];
            h.iter_mut().zip(lower).take(a).for_each(|(row, value)| row[a] = value);
        }
        h
    }

    /// Solves for the first `n` unknowns; the others are 0.
    fn solve(&self, n: usize) -> Option<[f64; 6]> {
        let l = cholesky(&self.with_prior(), n)?;
        let mut x = substitute(&l, n, &self.g);
        x.iter_mut().for_each(|x| *x = -*x);
        Some(x)
    }

    fn covariance(&self) -> [[f64; 6]; 6] {
        let Some(l) = cholesky(&self.with_prior(), 6) else { return [[f64::INFINITY; 6]; 6] };
        std::array::from_fn(|k| substitute(&l, 6, &std::array::from_fn(|i| f64::from(u8::from(i == k)))))
    }
}

/// L of L Lᵀ = A, of the first `n` rows; `None` when A is not positive definite.
fn cholesky(a: &[[f64; 6]; 6], n: usize) -> Option<[[f64; 6]; 6]> {
    let mut l = [[0.0; 6]; 6];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            l[i][j] = if i == j {
                if sum <= 0.0 {
                    return None;
                }
                sum.sqrt()
            } else {
                sum / l[j][j]
            };
        }
    }
    Some(l)
}

/// x of L Lᵀ x = b, of the first `n` rows; the others are 0.
fn substitute(l: &[[f64; 6]; 6], n: usize, b: &[f64; 6]) -> [f64; 6] {
    let mut x = [0.0; 6];
    for i in 0..n {
        x[i] = (b[i] - (0..i).map(|k| l[i][k] * x[k]).sum::<f64>()) / l[i][i];
    }
    for i in (0..n).rev() {
        x[i] = (x[i] - (i + 1..n).map(|k| l[k][i] * x[k]).sum::<f64>()) / l[i][i];
    }
    x
}
