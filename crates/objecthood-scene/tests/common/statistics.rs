//! What tells a real depth image of a table from a synthetic one, measured the same way on both.

use std::path::Path;

use objecthood_eval::mosd::ROLES;
use objecthood_eval::{Split, scenes};

/// docs/CONTEXT.md 0.2: what a Kinect v1 resolves.
const QUANTUM_PER_M: f64 = 0.00285;
/// docs/CONTEXT.md 0.3: half window, share of it that must have depth.
const FIT_RADIUS_PX: usize = 3;
const MIN_FILL: f64 = 0.4;
const BORDER_PX: usize = 5;

/// Of one data set.
#[derive(Debug)]
pub(crate) struct Statistics {
    /// Median over the scenes of the median plane-fit residual (quanta), docs/CONTEXT.md 0.3.
    pub(crate) fit_residual: f64,
    /// Median over the scenes of the deviation from the table's plane (quanta).
    pub(crate) table_residual: f64,
    /// Share of pixels without depth among those within 5 px of the border of an object's mask.
    pub(crate) missing_at_borders: f64,
    /// Share of pixels without depth in the columns just left and right of object pixels, and above and below them.
    pub(crate) missing_beside: [f64; 4],
}

struct Image {
    width: usize,
    height: usize,
    /// Quanta; `NaN` = none.
    disparity: Vec<f64>,
    label: Vec<u32>,
}

impl Statistics {
    /// Of all scenes in `root/learn`.
    pub(crate) fn of_learn(root: &Path) -> Self {
        let (mut fits, mut tables) = (Vec::new(), Vec::new());
        let (mut at_borders, mut missing) = (0, 0);
        let mut beside = [[0_usize; 2]; 4];
        for scene in scenes(root, &Split::Folder("learn".into())).unwrap() {
            let scene = scene.load(None).unwrap();
            let (width, height) = scene.frame.size();
            let quanta = |z: &f32| 1.0 / (f64::from(*z) * QUANTUM_PER_M);
            let disparity: Vec<f64> = scene.frame.depth_m().as_slice().iter().map(quanta).collect();
            let image = Image { width, height, disparity, label: scene.truth.labels().as_slice().to_vec() };
            fits.push(median((0..width * height).filter_map(|i| image.fit_residual(i)).collect()));
            tables.push(image.table_residual());
            let border = image.near_borders();
            at_borders += border.iter().filter(|&&near| near).count();
            missing += (0..border.len()).filter(|&i| border[i] && image.disparity[i].is_nan()).count();
            image.add_beside(&mut beside);
        }
        Self {
            fit_residual: median(fits),
            table_residual: median(tables),
            missing_at_borders: missing as f64 / at_borders as f64,
            missing_beside: beside.map(|[missing, all]| missing as f64 / all as f64),
        }
    }
}

impl Image {
    /// Deviation from the plane fitted to the pixels around (quanta).
    fn fit_residual(&self, i: usize) -> Option<f64> {
        let own = self.disparity[i];
        if own.is_nan() {
            return None;
        }
        let (u, v) = (i % self.width, i / self.width);
        let mut plane = PlaneFit::default();
        for y in v.saturating_sub(FIT_RADIUS_PX)..(v + FIT_RADIUS_PX + 1).min(self.height) {
            for x in u.saturating_sub(FIT_RADIUS_PX)..(u + FIT_RADIUS_PX + 1).min(self.width) {
                let d = self.disparity[y * self.width + x];
                if !d.is_nan() {
                    plane.add(x as f64 - u as f64, y as f64 - v as f64, d - own);
                }
            }
        }
        let side = 2 * FIT_RADIUS_PX + 1;
        let solved = (plane.n >= MIN_FILL * (side * side) as f64).then(|| plane.solve())??;
        Some((solved.variance * plane.n / (plane.n - 3.0)).sqrt())
    }

    /// Deviation of the table from its plane (quanta), by a least-squares fit without what is beyond 4 deviations.
    fn table_residual(&self) -> f64 {
        let place = |i: usize| ((i % self.width) as f64, (i / self.width) as f64, self.disparity[i]);
        let mut table: Vec<usize> = (0..self.label.len())
            .filter(|&i| Some(self.label[i]) == ROLES.background && !self.disparity[i].is_nan())
            .collect();
        let mut deviation = 0.0;
        for _ in 0..6 {
            let mut plane = PlaneFit::default();
            table.iter().map(|&i| place(i)).for_each(|(u, v, d)| plane.add(u, v, d));
            let plane = plane.solve().unwrap();
            deviation = plane.variance.sqrt();
            table.retain(|&i| {
                let (u, v, d) = place(i);
                (d - plane.at(u, v)).abs() < 4.0 * deviation
            });
        }
        deviation
    }

    fn is_object(&self, i: usize) -> bool {
        self.label[i] >= 2
    }

    /// Pixels within 5 px of a border of an object's mask.
    fn near_borders(&self) -> Vec<bool> {
        let mut near = vec![false; self.label.len()];
        let reach = BORDER_PX as isize;
        for i in 0..self.label.len() {
            let (u, v) = (i % self.width, i / self.width);
            let differs =
                |j: usize| self.label[i] != self.label[j] && (self.is_object(i) || self.is_object(j));
            let right = u + 1 < self.width && differs(i + 1);
            let below = v + 1 < self.height && differs(i + self.width);
            if !right && !below {
                continue;
            }
            for dy in -reach..=reach {
                for dx in -reach..=reach {
                    let (x, y) = (u as isize + dx, v as isize + dy);
                    let inside =
                        (0..self.width as isize).contains(&x) && (0..self.height as isize).contains(&y);
                    if inside && dx * dx + dy * dy <= reach * reach {
                        near[y as usize * self.width + x as usize] = true;
                    }
                }
            }
        }
        near
    }

    /// Counts, for each side, neighbours of objects that are none, and those of them without depth.
    fn add_beside(&self, counts: &mut [[usize; 2]; 4]) {
        for v in 1..self.height - 1 {
            for u in 1..self.width - 1 {
                let i = v * self.width + u;
                if self.is_object(i) {
                    for (count, j) in counts.iter_mut().zip([i - 1, i + 1, i - self.width, i + self.width]) {
                        if !self.is_object(j) {
                            count[1] += 1;
                            count[0] += usize::from(self.disparity[j].is_nan());
                        }
                    }
                }
            }
        }
    }
}

/// Sums for a least-squares plane d = a u + b v + c.
#[derive(Default)]
struct PlaneFit {
    n: f64,
    sums: [f64; 9],
}

struct Plane {
    a: f64,
    b: f64,
    mean: [f64; 3],
    /// Mean square deviation.
    variance: f64,
}

impl PlaneFit {
    fn add(&mut self, u: f64, v: f64, d: f64) {
        self.n += 1.0;
        for (sum, x) in self.sums.iter_mut().zip([u, v, d, u * u, u * v, v * v, u * d, v * d, d * d]) {
            *sum += x;
        }
    }

    fn solve(&self) -> Option<Plane> {
        let [u, v, d, uu, uv, vv, ud, vd, dd] = self.sums.map(|sum| sum / self.n);
        let (uu, uv, vv) = (uu - u * u, uv - u * v, vv - v * v);
        let (ud, vd, dd) = (ud - u * d, vd - v * d, dd - d * d);
        let det = uu * vv - uv * uv;
        if det < 1e-3 {
            return None;
        }
        let (a, b) = ((ud * vv - vd * uv) / det, (vd * uu - ud * uv) / det);
        Some(Plane { a, b, mean: [u, v, d], variance: (dd - a * ud - b * vd).max(0.0) })
    }
}

impl Plane {
    fn at(&self, u: f64, v: f64) -> f64 {
        self.mean[2] + self.a * (u - self.mean[0]) + self.b * (v - self.mean[1])
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
