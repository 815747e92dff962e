//! What every shape must satisfy, checked against dense sampling of its implicit function.

use glam::DVec3;

use super::Shape;
use crate::random::Rng;
use crate::ray::Ray;

/// Whether a point lies inside a shape, by means that have nothing in common with its rays and supports.
pub(crate) fn contains(shape: &Shape, p: DVec3) -> bool {
    match shape {
        Shape::Cuboid(shape) => p.abs().cmplt(shape.half_m).all(),
        Shape::Revolved(shape) => shape.contains(libm::hypot(p.x, p.y), p.z),
        Shape::TorusArc(shape) => shape.contains(p),
    }
}

const RAYS: usize = 3000;
/// Rounding (m), and how far apart the samples along a ray lie, as a share of the shape's radius.
const ROUNDING_M: f64 = 1e-11;
const SAMPLE: f64 = 1.0 / 1000.0;

/// Rays from all sides and from within meet `shape` where the function `inside` changes; the normal is that of the
/// plane through neighbouring hits and points outwards; nothing sticks out of the supports.
pub(super) fn check(shape: &Shape, inside: impl Fn(DVec3) -> bool) {
    let (center, radius) = shape.bounding_sphere();
    let mut rng = Rng::new(1, 0);
    let mut point =
        |scale: f64| DVec3::from([0, 1, 2].map(|_| rng.range(-1.0..1.0))) * radius * scale + center;
    let (mut hits, mut misses, mut normals) = (0, 0, 0);
    for i in 0..RAYS {
        let origin = if i % 4 == 0 { point(0.8) } else { point(3.0) };
        let ray = Ray { origin, direction: (point(0.7) - origin) * 1.3 };
        let speed = ray.direction.length();
        let hit = shape.hit(ray, 0.0);
        let sampled = first_change(ray, &inside, radius);

        // Samples may step over a thin piece, the shape over nothing that lasts longer than a sample.
        if let Some(t) = sampled
            && hit.is_none_or(|hit| hit.t > t + ROUNDING_M / speed)
        {
            let beyond = ray.at(t + 2.0 * SAMPLE * radius / speed);
            assert!(
                inside(beyond) == inside(origin),
                "{hit:?}, but the boundary is crossed at {t} by {ray:?} of {shape:?}"
            );
            continue;
        }
        let Some(hit) = hit else {
            misses += 1;
            continue;
        };
        hits += 1;
        let just = |side: f64| inside(ray.at(hit.t + side * ROUNDING_M / speed));
        let skims = hit.normal.dot(ray.direction).abs() < 0.02 * speed;
        assert!(skims || just(-1.0) != just(1.0), "{hit:?}, but no boundary is there, rather at {sampled:?}");
        assert!((hit.normal.length() - 1.0).abs() < 1e-12);
        assert!(hit.surface < shape.surfaces());
        assert_eq!(hit.normal.dot(ray.direction) > 0.0, inside(origin), "the normal points outwards");
        normals += usize::from(normal_agrees(shape, ray, hit.normal, hit.surface));
        for direction in [hit.normal, DVec3::X, DVec3::NEG_Z, DVec3::new(0.3, -0.5, 0.2)] {
            assert!(ray.at(hit.t).dot(direction) < shape.support(direction) + 1e-9);
        }
    }
    assert!(hits > RAYS / 5 && misses > 0, "{hits} hits, {misses} misses");
    assert!(normals > hits / 2, "{normals} of {hits} normals could be checked");
    supports_are_reached(shape, inside, center, radius);
}

/// The first t > 0 at which the function changes: samples, then bisection.
fn first_change(ray: Ray, inside: impl Fn(DVec3) -> bool, radius: f64) -> Option<f64> {
    let start = inside(ray.origin);
    let step = SAMPLE * radius / ray.direction.length();
    let first = (1..10_000).map(|i| f64::from(i) * step).find(|&t| inside(ray.at(t)) != start)?;
    let (mut before, mut behind) = (first - step, first);
    for _ in 0..60 {
        let middle = (before + behind) / 2.0;
        if inside(ray.at(middle)) == start { before = middle } else { behind = middle }
    }
    Some(behind)
}

/// Compares the normal with the plane through the hits of neighbouring rays, where these meet the same face.
fn normal_agrees(shape: &Shape, ray: Ray, normal: DVec3, surface: usize) -> bool {
    let (a, b) = ray.direction.normalize().any_orthonormal_pair();
    let at = |shift: DVec3| {
        let moved = Ray { origin: ray.origin + shift * 1e-6, direction: ray.direction };
        shape.hit(moved, 0.0).filter(|hit| hit.surface == surface).map(|hit| moved.at(hit.t))
    };
    let (Some(a0), Some(a1), Some(b0), Some(b1)) = (at(-a), at(a), at(-b), at(b)) else { return false };
    if normal.dot(ray.direction.normalize()).abs() < 0.1 || (a1 - a0).length() + (b1 - b0).length() > 1e-4 {
        return false;
    }
    let numeric = (a1 - a0).cross(b1 - b0).normalize();
    assert!(numeric.dot(normal).abs() > 1.0 - 1e-6, "normal {normal} but differences say {numeric}");
    true
}

/// Samples of the inside come close to the support in many directions, and never beyond.
fn supports_are_reached(shape: &Shape, inside: impl Fn(DVec3) -> bool, center: DVec3, radius: f64) {
    let cells = 60;
    let place = |i: i32| (f64::from(i) + 0.5) / f64::from(cells) * 2.0 - 1.0;
    let mut samples = Vec::new();
    for (x, y, z) in (0..cells).flat_map(|x| (0..cells).flat_map(move |y| (0..cells).map(move |z| (x, y, z))))
    {
        let point = center + DVec3::new(place(x), place(y), place(z)) * radius;
        if inside(point) {
            samples.push(point);
        }
    }
    let mut rng = Rng::new(2, 0);
    for _ in 0..50 {
        let direction = DVec3::from([0, 1, 2].map(|_| rng.range(-1.0..1.0))).normalize();
        let reached = samples.iter().map(|p| p.dot(direction)).fold(f64::NEG_INFINITY, f64::max);
        let support = shape.support(direction);
        assert!(reached <= support && support < reached + radius * 0.08, "{direction}: {reached} {support}");
    }
}
