//! The world through a pinhole: exact geometry of every pixel, before any sensor.

use objecthood::Raster;
use rayon::prelude::*;

use crate::truth::Truth;
use crate::world::{Sight, World};

/// What the ray through the middle of every pixel meets.
pub(crate) struct View {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Row by row; the t of a sight is its depth (m).
    pub(crate) sights: Vec<Option<Sight>>,
    /// For each solid, how many pixels it would have if it were alone.
    alone_px: Vec<u32>,
}

impl View {
    pub(crate) fn of(world: &World) -> Self {
        let viewpoint = world.viewpoint();
        let (width, height) = viewpoint.size_px;
        let mut sights = vec![None; width * height];
        let solids = world.solids().len();
        let rows = sights.par_chunks_mut(width.max(1)).enumerate().map(|(v, row)| {
            let mut alone = vec![0; solids];
            for (u, sight) in row.iter_mut().enumerate() {
                *sight = world.first(viewpoint.ray(u as f64, v as f64), &mut alone);
            }
            alone
        });
        let add = |mut a: Vec<u32>, b: Vec<u32>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
            a
        };
        let alone_px = rows.reduce(|| vec![0; solids], add);
        Self { width, height, sights, alone_px }
    }

    /// For each solid, how many pixels it would have if it were alone.
    pub(crate) fn alone_px(&self) -> &[u32] {
        &self.alone_px
    }

    /// Instance and surface of every pixel.
    pub(crate) fn truth(&self) -> objecthood::Result<Truth> {
        let raster = |of: fn(&Sight) -> u16| {
            let values = self.sights.iter().map(|sight| sight.as_ref().map_or(0, of)).collect();
            Raster::from_vec(self.width, self.height, values)
        };
        Ok(Truth { instance: raster(|sight| sight.instance)?, surface: raster(|sight| sight.surface)? })
    }

    /// What the outermost rows and columns see.
    pub(crate) fn border(&self) -> impl Iterator<Item = Option<&Sight>> {
        let is_border = |i: usize| {
            let (u, v) = (i % self.width, i / self.width);
            u == 0 || v == 0 || u + 1 == self.width || v + 1 == self.height
        };
        self.sights.iter().enumerate().filter(move |&(i, _)| is_border(i)).map(|(_, sight)| sight.as_ref())
    }

    /// For each solid, the pixels it has over the pixels it would have if it were alone; 0 outside the image.
    pub(crate) fn visible_fractions(&self) -> Vec<f64> {
        let mut seen_px = vec![0_u32; self.alone_px.len()];
        for sight in self.sights.iter().flatten() {
            seen_px[usize::from(sight.instance) - 1] += 1;
        }
        let share = |(&seen, &alone): (&u32, &u32)| f64::from(seen) / f64::from(alone.max(1));
        seen_px.iter().zip(&self.alone_px).map(share).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::family::{Family, generate};
    use crate::pose::Pose;
    use crate::ray::Ray;
    use crate::solid::Probe;
    use crate::world::Viewpoint;

    const STEP_M: f64 = 0.0004;

    /// Instance and depth where a ray first enters a solid, found by walking along it.
    fn walk(probe: &Probe, ray: Ray) -> Option<(u16, f64)> {
        let inside = |t: f64| probe.at(ray.at(t)).next();
        let step = STEP_M / ray.direction.length();
        let (mut before, mut solid) = (0.0, None);
        for k in 1..15_000 {
            let t = f64::from(k) * step;
            solid = inside(t);
            if solid.is_some() {
                break;
            }
            before = t;
        }
        let mut behind = before + step;
        let mut solid = solid?;
        for _ in 0..40 {
            let middle = (before + behind) / 2.0;
            match inside(middle) {
                Some(found) => (behind, solid) = (middle, found),
                None => before = middle,
            }
        }
        Some((solid as u16 + 1, behind))
    }

    /// Compares every `stride`-th pixel with a walk along its ray: how many agree, and how many were skimmed, where
    /// the walk steps over what is thinner than its step.
    fn compare(name: &str, world: &World, stride: usize) -> (usize, usize) {
        let probe = Probe::new(world.solids());
        let view = View::of(world);
        let truth = view.truth().unwrap();
        let (mut agree, mut skimmed) = (0, 0);
        for i in (0..view.sights.len()).step_by(stride) {
            let ray = world.viewpoint().ray((i % view.width) as f64, (i / view.width) as f64);
            let walked = walk(&probe, ray);
            let Some(sight) = view.sights[i] else {
                assert!(walked.is_none(), "{name} pixel {i}: nothing instead of {walked:?}");
                continue;
            };
            assert_eq!(truth.instance[i], sight.instance);
            match walked {
                Some((instance, t)) if instance == sight.instance && (t - sight.t).abs() < 2e-6 => agree += 1,
                _ => {
                    let length = ray.direction.length();
                    let is_inside = |along: f64| {
                        let instances = probe.at(ray.at(sight.t + along / length)).map(|k| k as u16 + 1);
                        instances.into_iter().any(|k| k == sight.instance)
                    };
                    let is_boundary = is_inside(1e-6) && !is_inside(-1e-6);
                    assert!(
                        is_boundary && !is_inside(STEP_M),
                        "{name} pixel {i}: {sight:?}, walked to {walked:?}"
                    );
                    skimmed += 1;
                }
            }
        }
        (agree, skimmed)
    }

    #[test]
    fn truth_is_the_first_hit() {
        let (mut agree, mut skimmed) = (0, 0);
        for (family, seed) in Family::ALL.into_iter().zip(3..) {
            // A stride that visits all columns.
            let (a, s) = compare(family.name(), &generate(family, seed), 1009);
            (agree, skimmed) = (agree + a, skimmed + s);
        }
        assert!(agree > 4000 && skimmed < agree / 100, "{agree} agree, {skimmed} skimmed");
    }

    #[test]
    fn truth_is_the_first_hit_from_anywhere() {
        let world = generate(Family::Clutter, 4);
        let camera = objecthood::Camera { fx_px: 90.0, fy_px: 70.0, cx_px: 40.0, cy_px: 70.0 };
        let target_m = [0.0, 0.0, 0.75];
        let (mut agree, mut skimmed) = (0, 0);
        // Straight above, below the table, from behind, level with the table's top, close to it.
        for eye_m in
            [[0.0, 0.0, 2.0], [0.1, -0.3, 0.2], [0.3, 0.9, 1.3], [-1.5, 0.2, 0.7401], [0.5, -0.6, 0.9]]
        {
            let pose = Pose::looking_at(eye_m, target_m).turned(2, 30.0);
            let viewpoint = Viewpoint { camera, size_px: (160, 120), pose };
            let (a, s) = compare(&format!("{eye_m:?}"), &world.with_viewpoint(viewpoint).unwrap(), 37);
            (agree, skimmed) = (agree + a, skimmed + s);
        }
        assert!(agree > 2000 && skimmed < agree / 50, "{agree} agree, {skimmed} skimmed");
    }

    #[test]
    fn surfaces_are_those_of_their_instance() {
        let world = generate(Family::Vessels, 1);
        let truth = View::of(&world).truth().unwrap();
        let mut first = vec![1];
        world.solids().iter().for_each(|solid| first.push(first[first.len() - 1] + solid.surfaces()));
        for (&instance, &surface) in truth.instance.as_slice().iter().zip(truth.surface.as_slice()) {
            let k = usize::from(instance);
            assert!(
                k > 0 && (first[k - 1]..first[k]).contains(&usize::from(surface)),
                "{instance} {surface}"
            );
        }
    }

    #[test]
    fn visible_fractions_are_those_of_pictures_with_and_without_the_others() {
        let world = generate(Family::Occluded, 1);
        let visible = View::of(&world).visible_fractions();
        let count = |view: &View, instance| {
            view.sights.iter().flatten().filter(|sight| sight.instance == instance).count() as f64
        };
        let together = View::of(&world);
        for instance in world.objects() {
            let alone = world.with_only(instance);
            let share = count(&together, instance) / count(&View::of(&alone), 1);
            assert!((share - visible[usize::from(instance) - 1]).abs() < 1e-12, "{instance}");
        }
        assert!(visible.iter().any(|&share| share < 0.75));
    }

    #[test]
    fn normals_face_the_camera() {
        let world = generate(Family::Clutter, 2);
        let eye = world.viewpoint().pose.origin;
        for sight in View::of(&world).sights.iter().flatten() {
            assert!(sight.normal.dot(eye - sight.point) >= 0.0 && (sight.normal.length() - 1.0).abs() < 1e-9);
            assert_ne!(sight.normal, DVec3::ZERO);
        }
    }
}
