//! Which objects stand where.

use glam::{DVec2, DVec3, Vec3};
use objecthood_scene::random::Rng;

use super::polygon::Polygon;
use super::specimen::Specimen;
use super::table::Table;

/// Objects that a scene is meant to have: at least, and how many more at most.
const FEWEST: usize = 5;
const MORE: usize = 7;
/// Draws for each of them: not every one finds a place.
const DRAWS: usize = 6;
/// Probability that an object goes on another if one can carry it.
const STACKED: f64 = 0.45;
/// How far from the middle of what carries it an object is put along either axis (m).
const OFF_CENTER_M: f64 = 0.03;
/// How far from where an object of the data set stood another is put along either axis (m).
const OFF_PLACE_M: f64 = 0.1;
/// Gaps that are left between objects (m): touching, slit, apart.
const GAPS_M: [f64; 3] = [0.0, 0.005, 0.03];

/// How far an object may be turned (degrees) and moved (m): a camera at the same place would have seen nearly the same
/// of it. Vessels less, because what shows of their inside changes sooner.
const TURN_DEG: f64 = 12.0;
const MOVE_M: f64 = 0.35;
const VESSEL_TURN_DEG: f64 = 5.0;
const VESSEL_MOVE_M: f64 = 0.15;

/// An object at its place.
pub(super) struct Placement<'a> {
    pub(super) specimen: &'a Specimen,
    /// Cosine and sine of the angle by which it is turned.
    rotation: DVec2,
    /// Where its middle is (m).
    at: DVec2,
    /// How high it stands (m).
    base_m: f64,
    /// Which placement carries it; none: the table.
    pub(super) carrier: Option<usize>,
    /// What it covers of the ground.
    pub(super) footprint: Polygon,
}

impl<'a> Placement<'a> {
    fn new(specimen: &'a Specimen, turn_deg: f64, at: DVec2, base_m: f64, carrier: Option<usize>) -> Self {
        let (sin, cos) = libm::sincos(turn_deg.to_radians());
        let rotation = DVec2::new(cos, sin);
        Self { specimen, rotation, at, base_m, carrier, footprint: specimen.footprint.placed(rotation, at) }
    }

    /// Where a point of the specimen is, on the ground (m).
    pub(super) fn point(&self, own: Vec3) -> DVec3 {
        let own = own.as_dvec3();
        (self.rotation.rotate(own.truncate()) + self.at).extend(own.z + self.base_m)
    }

    /// Where a point of the ground is on the specimen (m).
    #[cfg(test)]
    pub(super) fn own_point(&self, ground: DVec3) -> DVec3 {
        let back = DVec2::new(self.rotation.x, -self.rotation.y);
        back.rotate(ground.truncate() - self.at).extend(ground.z - self.base_m)
    }

    fn is_level_with(&self, other: &Self) -> bool {
        self.base_m < other.base_m + other.specimen.height_m
            && other.base_m < self.base_m + self.specimen.height_m
    }
}

/// Draws objects and places until as many stand as wanted or the draws are used up. O(draws · objects).
pub(super) fn place<'a>(specimens: &'a [Specimen], table: &Table, rng: &mut Rng) -> Vec<Placement<'a>> {
    let wanted = FEWEST + rng.below(MORE + 1);
    let mut placed: Vec<Placement<'a>> = Vec::new();
    for _ in 0..DRAWS * wanted {
        if placed.len() < wanted
            && let Some(next) = draw(specimens, &placed, rng)
            && fits(&next, &placed, table, rng.pick(&GAPS_M))
        {
            placed.push(next);
        }
    }
    placed
}

/// An object and a place that is not too far from its own.
fn draw<'a>(specimens: &'a [Specimen], placed: &[Placement<'a>], rng: &mut Rng) -> Option<Placement<'a>> {
    let specimen = &specimens[rng.below(specimens.len())];
    let turn_deg = if specimen.is_vessel { VESSEL_TURN_DEG } else { TURN_DEG };
    let turn_deg = rng.range(-turn_deg..turn_deg);
    let free = free_tops(placed);
    if !free.is_empty() && rng.chance(STACKED) {
        let carrier = rng.pick(&free);
        let below = &placed[carrier];
        let top = below.specimen.top.as_ref()?;
        let at = below.rotation.rotate(top.center) + below.at + within(OFF_CENTER_M, rng);
        let is_near = at.distance(specimen.home) <= MOVE_M;
        return is_near.then(|| Placement::new(specimen, turn_deg, at, top.height_m, Some(carrier)));
    }
    // Near where some object of the data set stood: that is where its camera looked, so scenes become crowded there.
    let farthest_m = if specimen.is_vessel { VESSEL_MOVE_M } else { MOVE_M };
    let at = specimens[rng.below(specimens.len())].home + within(OFF_PLACE_M, rng);
    let is_near = at.distance(specimen.home) <= farthest_m;
    is_near.then(|| Placement::new(specimen, turn_deg, at, 0.0, None))
}

/// What stands on the table, can carry something and does not yet.
fn free_tops(placed: &[Placement<'_>]) -> Vec<usize> {
    let is_free = |&k: &usize| {
        placed[k].carrier.is_none()
            && placed[k].specimen.top.is_some()
            && placed.iter().all(|other| other.carrier != Some(k))
    };
    (0..placed.len()).filter(is_free).collect()
}

/// Uniform in the square of this half side (m).
fn within(half_m: f64, rng: &mut Rng) -> DVec2 {
    let x = rng.range(-half_m..half_m);
    DVec2::new(x, rng.range(-half_m..half_m))
}

/// Whether it stands on the table and keeps a gap from all that reaches as high, but for what carries it.
fn fits(next: &Placement<'_>, placed: &[Placement<'_>], table: &Table, gap_m: f64) -> bool {
    let is_clear = |(k, other): (usize, &Placement<'_>)| {
        next.carrier == Some(k)
            || !next.is_level_with(other)
            || next.footprint.gap_m(&other.footprint) >= gap_m
    };
    table.outline.contains(&next.footprint) && placed.iter().enumerate().all(is_clear)
}
