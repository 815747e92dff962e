//! A scene: what stands where, how it is lit, who looks at it.

use glam::DVec3;
use objecthood::{Camera, Raster};

use crate::contact::Contact;
use crate::error::{Error, Result};
use crate::light::Lighting;
use crate::pose::Pose;
use crate::ray::{Hit, Ray};
use crate::shape::Shape;
use crate::solid::{Role, Solid};
use crate::texture::Paint;

/// A scene with exact truth.
///
/// Frame of the world: z up, metres. Solid k has the instance number k + 1, whatever its role.
#[derive(Clone, Debug)]
pub struct World {
    seed: u64,
    /// What the noise of its pictures is made from.
    noise_seed: u64,
    /// What light is multiplied by; `None` = such that the brightest hundredth of the picture is just not white.
    exposure: Option<f64>,
    solids: Vec<Solid>,
    contacts: Vec<Contact>,
    pub(crate) lighting: Lighting,
    viewpoint: Viewpoint,
    parts: Vec<Placed>,
}

/// A camera somewhere in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Its intrinsics.
    pub camera: Camera,
    /// Columns and rows of its image.
    pub size_px: (usize, usize),
    /// Takes the camera frame (x right, y down, z forward) to the world.
    pub pose: Pose,
}

/// A part of a solid, ready to be hit.
#[derive(Clone, Debug)]
struct Placed {
    shape: Shape,
    pose: Pose,
    center: DVec3,
    radius: f64,
    /// Lowest and highest coordinates, a little beyond.
    low: DVec3,
    high: DVec3,
    solid: usize,
    /// Scene-wide number of its first face.
    first_surface: u16,
    paints: Vec<Paint>,
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// In lengths of the ray's direction; of a ray with z = 1 in the camera frame: the depth (m).
    pub(crate) t: f64,
    pub(crate) point: DVec3,
    pub(crate) normal: DVec3,
    pub(crate) instance: u16,
    pub(crate) surface: u16,
    part: usize,
    uv_m: [f64; 2],
}

/// What lies nearer to a surface than this (m) is the surface itself, for rays that leave it.
pub(crate) const SKIN_M: f64 = 1e-6;
/// A camera is no farther from the middle of the floor than this along any axis.
const FARTHEST_M: f64 = 1000.0;

impl World {
    pub(crate) fn new(
        seed: u64,
        solids: Vec<Solid>,
        contacts: Vec<Contact>,
        lighting: Lighting,
        viewpoint: Viewpoint,
    ) -> Self {
        let mut parts = Vec::new();
        let mut next_surface = 1_u16;
        for (solid, thing) in solids.iter().enumerate() {
            for part in &thing.parts {
                let pose = thing.pose.after(&part.pose);
                let (center, radius) = part.shape.bounding_sphere();
                let reach = |sign: f64| {
                    let along = DVec3::AXES.map(|axis| part.shape.support(pose.own_direction(axis * sign)));
                    pose.origin + (DVec3::from(along) + SKIN_M) * sign
                };
                parts.push(Placed {
                    shape: part.shape.clone(),
                    pose,
                    center: pose.point(center),
                    radius,
                    low: reach(-1.0),
                    high: reach(1.0),
                    solid,
                    first_surface: next_surface,
                    paints: part.paints.clone(),
                });
                next_surface += part.shape.surfaces() as u16;
            }
        }
        Self { seed, noise_seed: seed, exposure: None, solids, contacts, lighting, viewpoint, parts }
    }

    /// The same scene in a quarter of the columns and rows, for a quick look.
    pub(crate) fn at_quarter_size(&self) -> Self {
        let (width, height) = self.viewpoint.size_px;
        let size_px = (width / 4, height / 4);
        Self {
            viewpoint: Viewpoint { camera: self.camera_of(size_px), size_px, ..self.viewpoint },
            ..self.clone()
        }
    }

    /// The same scene in an image of so many columns and rows, seen by the same camera: its pixels keep their shape, and it sees
    /// as much from left to right. An image of other proportions shows more or less above and below.
    ///
    /// # Errors
    /// [`Error::Frame`] when there is no such image.
    pub fn at_size(&self, size_px: (usize, usize)) -> Result<Self> {
        self.with_viewpoint(Viewpoint { camera: self.camera_of(size_px), size_px, ..self.viewpoint })
    }

    /// The intrinsics of the camera for an image of another size.
    fn camera_of(&self, (width, height): (usize, usize)) -> Camera {
        let Viewpoint { camera: c, size_px, .. } = self.viewpoint;
        let (x, y) = (width as f64 / size_px.0 as f64, height as f64 / size_px.1 as f64);
        // One factor for both focal lengths: sensors have square pixels, whatever the proportions of the image.
        Camera {
            fx_px: c.fx_px * x,
            fy_px: c.fy_px * x,
            cx_px: (c.cx_px + 0.5) * x - 0.5,
            cy_px: (c.cy_px + 0.5) * y - 0.5,
        }
    }

    /// The same scene, seen from anywhere outside its solids, by any pinhole camera.
    ///
    /// What sensors do in pixels (windows, jitter) was measured at 640 x 480 with 525 px of focal length.
    ///
    /// # Errors
    /// [`Error::Frame`] when there is no such camera or image, [`Error::FarAway`] when the camera is not within 1 km of
    /// the scene.
    pub fn with_viewpoint(&self, viewpoint: Viewpoint) -> Result<Self> {
        viewpoint.camera.check()?;
        let (width, height) = viewpoint.size_px;
        Raster::filled(width, height, ())?;
        // Farther away a step along a ray would be lost in rounding.
        if !viewpoint.pose.origin.to_array().iter().all(|x| x.abs() <= FARTHEST_M) {
            return Err(Error::FarAway { origin_m: viewpoint.pose.origin_m() });
        }
        Ok(Self { viewpoint, ..self.clone() })
    }

    /// The same scene with pictures of this exposure and noise.
    pub(crate) fn exposed(self, exposure: f64, noise_seed: u64) -> Self {
        Self { exposure: Some(exposure), noise_seed, ..self }
    }

    /// What the scene and, unless it is a frame of a video, the noise of its pictures are made from.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// What the noise of its pictures is made from.
    pub(crate) fn noise_seed(&self) -> u64 {
        self.noise_seed
    }

    /// What light is multiplied by, if that is given.
    pub(crate) fn exposure(&self) -> Option<f64> {
        self.exposure
    }

    /// Everything there is; number k has the instance k + 1.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// Instance numbers of what can be grasped and moved, ascending.
    pub fn objects(&self) -> impl Iterator<Item = u16> + '_ {
        let objects = self.solids.iter().enumerate().filter(|(_, solid)| solid.role == Role::Object);
        objects.map(|(k, _)| k as u16 + 1)
    }

    /// Where every object stands, leans or lies, and what it touches: by upper, then by lower instance. What furniture
    /// rests on is not listed.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// The camera.
    pub fn viewpoint(&self) -> &Viewpoint {
        &self.viewpoint
    }

    /// The solid with this instance number, if there is one.
    pub fn solid(&self, instance: u16) -> Option<&Solid> {
        self.solids.get(usize::from(instance).checked_sub(1)?)
    }

    /// The first surface along a ray. Counts in `alone`, for every solid, whether the ray would meet it.
    pub(crate) fn first(&self, ray: Ray, alone: &mut [u32]) -> Option<Sight> {
        let mut nearest: Option<(Hit, usize)> = None;
        let mut last = usize::MAX;
        for (k, part) in self.parts.iter().enumerate() {
            if let Some(hit) = part.hit(ray) {
                // The parts of a solid stand together.
                alone[part.solid] += u32::from(last != part.solid);
                last = part.solid;
                if nearest.is_none_or(|(best, _)| hit.t < best.t) {
                    nearest = Some((hit, k));
                }
            }
        }
        nearest.map(|(hit, part)| self.sight(ray, hit, part))
    }

    fn sight(&self, ray: Ray, hit: Hit, part: usize) -> Sight {
        let placed = &self.parts[part];
        Sight {
            t: hit.t,
            point: ray.at(hit.t),
            normal: placed.pose.rotation * hit.normal,
            instance: placed.solid as u16 + 1,
            surface: placed.first_surface + hit.surface as u16,
            part,
            uv_m: hit.uv_m,
        }
    }

    /// Whether nothing lies between two points; the first may lie on a surface with this normal.
    pub(crate) fn sees(&self, from: DVec3, normal: DVec3, to: DVec3) -> bool {
        let toward = to - from;
        if toward.dot(normal) <= 0.0 {
            return false;
        }
        let ray = Ray { origin: from + normal * SKIN_M, direction: toward };
        let (start, end) = (ray.origin, ray.at(1.0));
        let (low, high) = (start.min(end), start.max(end));
        // Most parts are nowhere near the way: what the boxes tell is cheaper than what the rays tell.
        let mut near =
            self.parts.iter().filter(|part| part.low.cmple(high).all() && low.cmple(part.high).all());
        !near.any(|part| part.hit(ray).is_some_and(|hit| hit.t < 1.0 - 1e-9))
    }

    /// The colour of the surface where a ray met it.
    pub(crate) fn albedo(&self, sight: &Sight) -> [f64; 3] {
        self.paint(sight).albedo(sight.uv_m)
    }

    /// The paint of the surface where a ray met it.
    pub(crate) fn paint(&self, sight: &Sight) -> &Paint {
        let placed = &self.parts[sight.part];
        let face = usize::from(sight.surface - placed.first_surface);
        &placed.paints[face.min(placed.paints.len() - 1)]
    }
}

impl Placed {
    fn hit(&self, ray: Ray) -> Option<Hit> {
        if ray.passes(self.center, self.radius) { self.shape.hit(self.pose.own_ray(ray), 0.0) } else { None }
    }
}

impl Viewpoint {
    /// The ray of a pixel in the world; its t is the depth.
    pub(crate) fn ray(&self, u: f64, v: f64) -> Ray {
        let direction = DVec3::from(self.camera.ray(u, v));
        Ray { origin: self.pose.origin, direction: self.pose.rotation * direction }
    }
}

impl World {
    /// The same view of one solid alone; of nothing if there is no such solid.
    pub(crate) fn with_only(&self, instance: u16) -> Self {
        let solids = self.solid(instance).into_iter().cloned().collect();
        Self::new(self.seed, solids, Vec::new(), self.lighting.clone(), self.viewpoint)
    }
}

#[cfg(test)]
impl World {
    /// The same view and light of other solids.
    pub(crate) fn with_solids(&self, solids: Vec<Solid>) -> Self {
        Self::new(self.seed, solids, Vec::new(), self.lighting.clone(), self.viewpoint)
    }
}
