//! The picture of a composed scene while it is made.

use objecthood::surface::disparity::DisparitySpace;
use objecthood::{Camera, Frame};

use super::morphology::Mask;
use super::placement::Placement;
use super::table::Ground;

/// Instance of the pixels that show nothing.
pub(super) const NOTHING: u16 = 0;
/// Instance of the table; objects follow.
pub(super) const TABLE: u16 = 1;

/// Of two surfaces at one depth but for so many quanta the one drawn later is seen: as much is noise, and an object
/// would sink into what it stands on.
const SAME_DEPTH_QUANTA: f64 = 1.5;
/// Gaps between the points of an object that are an effect of moving it are so many pixels wide at most ..
const CRACK_PX: usize = 2;
/// .. and the holes in its silhouette of which nothing is known: its own shadows, the dark inside of a vessel.
const UNKNOWN_PX: usize = 28;

/// What every pixel shows.
pub(super) struct Canvas {
    pub(super) width: usize,
    pub(super) camera: Camera,
    /// Depth (m); infinite where there is nothing.
    pub(super) depth_m: Vec<f64>,
    pub(super) color: Vec<[u8; 3]>,
    pub(super) instance: Vec<u16>,
}

/// An object in the image: the nearest of its points at every pixel.
struct Silhouette {
    width: usize,
    /// Depth (m); infinite where there is no point.
    depth_m: Vec<f64>,
    /// Index of the point.
    point: Vec<usize>,
}

impl Canvas {
    /// That of a camera, with the colours of a frame and no depth.
    pub(super) fn new(frame: &Frame) -> Self {
        let pixels = frame.depth_m().len();
        Self {
            width: frame.size().0,
            camera: frame.camera(),
            depth_m: vec![f64::INFINITY; pixels],
            color: frame.color().map_or_else(|| vec![[128; 3]; pixels], |color| color.as_slice().to_vec()),
            instance: vec![NOTHING; pixels],
        }
    }

    /// Pixel `i` shows the table at this depth (m), with the colour that pixel `from` has.
    pub(super) fn show_table(&mut self, i: usize, from: usize, depth_m: f64) {
        self.depth_m[i] = depth_m;
        self.color[i] = self.color[from];
        self.instance[i] = TABLE;
    }

    /// Draws an object where nothing is nearer. O(pixels + points).
    pub(super) fn draw(
        &mut self,
        object: &Placement<'_>,
        instance: u16,
        ground: Ground,
        space: &DisparitySpace,
    ) {
        let seen = self.silhouette(object, ground);
        let [mask, filled, whole] =
            [0, CRACK_PX / 2, UNKNOWN_PX / 2].map(|radius| seen.mask().closed(radius).pixels);
        let unknown_m = seen.mean_depth_m();
        for i in 0..self.depth_m.len() {
            if mask[i] || filled[i] {
                let from = if mask[i] { Some(i) } else { seen.nearest(i) };
                let Some(from) = from else { continue };
                if self.is_before(seen.depth_m[from], i, space) {
                    self.depth_m[i] = seen.depth_m[from];
                    self.color[i] = object.specimen.colors[seen.point[from]];
                    self.instance[i] = instance;
                }
            } else if whole[i] && self.is_before(unknown_m, i, space) {
                // There is something, but nothing was measured.
                self.depth_m[i] = unknown_m;
                self.instance[i] = NOTHING;
            }
        }
    }

    fn is_before(&self, depth_m: f64, i: usize, space: &DisparitySpace) -> bool {
        depth_m < self.depth_m[i] + space.step_m(SAME_DEPTH_QUANTA, depth_m)
    }

    fn silhouette(&self, object: &Placement<'_>, ground: Ground) -> Silhouette {
        let (width, height) = (self.width, self.depth_m.len() / self.width);
        let pixels = self.depth_m.len();
        let mut seen = Silhouette { width, depth_m: vec![f64::INFINITY; pixels], point: vec![0; pixels] };
        let Camera { fx_px, fy_px, cx_px, cy_px } = self.camera;
        for (k, &own) in object.specimen.points_m.iter().enumerate() {
            let p = ground.camera_point(object.point(own));
            let (u, v) = ((fx_px * p.x / p.z + cx_px).round(), (fy_px * p.y / p.z + cy_px).round());
            if p.z > 0.0 && (0.0..width as f64).contains(&u) && (0.0..height as f64).contains(&v) {
                let i = v as usize * width + u as usize;
                if p.z < seen.depth_m[i] {
                    (seen.depth_m[i], seen.point[i]) = (p.z, k);
                }
            }
        }
        seen
    }
}

impl Silhouette {
    fn mask(&self) -> Mask {
        Mask { width: self.width, pixels: self.depth_m.iter().map(|z| z.is_finite()).collect() }
    }

    /// The pixel with a point that is next to pixel `i`: first of those beside it, then of those at its corners.
    fn nearest(&self, i: usize) -> Option<usize> {
        let around = [(0, -1), (-1, 0), (1, 0), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)];
        let height = self.depth_m.len() / self.width;
        let neighbours = around.into_iter().filter_map(|(du, dv): (isize, isize)| {
            let (u, v) = ((i % self.width).wrapping_add_signed(du), (i / self.width).wrapping_add_signed(dv));
            (u < self.width && v < height).then(|| v * self.width + u)
        });
        neighbours.into_iter().find(|&j| self.depth_m[j].is_finite())
    }

    fn mean_depth_m(&self) -> f64 {
        let (sum, count) = self
            .depth_m
            .iter()
            .filter(|z| z.is_finite())
            .fold((0.0, 0_usize), |(sum, n), z| (sum + z, n + 1));
        sum / count as f64
    }
}
