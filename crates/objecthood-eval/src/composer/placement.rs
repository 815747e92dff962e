//! Which objects stand where.

use glam::{DVec2, DVec3, Vec3};
use objecthood_scene::random::Rng;

use super::polygon::Polygon;
use super::specimen::{Specimen, Top};
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
/// Probability that an object is pushed towards its neighbour.
const PUSHED: f64 = 0.5;
/// Steps in which the place where it comes to rest is found: a thousandth of the way.
const BISECTIONS: usize = 10;
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

    fn moved(&self, way_m: DVec2) -> Self {
        let at = self.at + way_m;
        Self { at, footprint: self.specimen.footprint.placed(self.rotation, at), ..*self }
    }

    /// Whether a camera would still see nearly the same of it as where it stood.
    fn is_near_home(&self) -> bool {
        let on_table = self.carrier.is_none();
        let farthest_m = if self.specimen.is_vessel && on_table { VESSEL_MOVE_M } else { MOVE_M };
        self.at.distance(self.specimen.home) <= farthest_m
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
        let (next, gap_m) = (draw(specimens, &placed, rng), rng.pick(&GAPS_M));
        if fits(&next, &placed, table, gap_m) {
            placed.push(if rng.chance(PUSHED) { pushed(next, &placed, table, gap_m) } else { next });
        }
        if placed.len() == wanted {
            break;
        }
    }
    placed
}

/// Pushed towards the nearest object until no more than the gap is left, or as far as it may be moved: objects that are
/// put down at random hardly ever touch.
fn pushed<'a>(next: Placement<'a>, placed: &[Placement<'a>], table: &Table, gap_m: f64) -> Placement<'a> {
    let beside = placed.iter().filter(|other| next.carrier.is_none() && next.is_level_with(other));
    let gap = |other: &&Placement<'_>| next.footprint.gap_m(&other.footprint);
    let Some(nearest) = beside.min_by(|a, b| gap(a).total_cmp(&gap(b))) else { return next };
    let moved = |share: f64| next.moved(share * (nearest.at - next.at));
    let (mut free, mut blocked) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = (free + blocked) / 2.0;
        let there = moved(middle);
        if fits(&there, placed, table, gap_m) { free = middle } else { blocked = middle }
    }
    moved(free)
}

/// An object and a place for it.
fn draw<'a>(specimens: &'a [Specimen], placed: &[Placement<'a>], rng: &mut Rng) -> Placement<'a> {
    let specimen = &specimens[rng.below(specimens.len())];
    let turn_deg = if specimen.is_vessel { VESSEL_TURN_DEG } else { TURN_DEG };
    let turn_deg = rng.range(-turn_deg..turn_deg);
    let free = free_tops(placed);
    if !free.is_empty() && rng.chance(STACKED) {
        let (carrier, top) = rng.pick(&free);
        let below = &placed[carrier];
        let at = below.rotation.rotate(top.center) + below.at + within(OFF_CENTER_M, rng);
        return Placement::new(specimen, turn_deg, at, top.height_m, Some(carrier));
    }
    // Near where some object of the data set stood: that is where its camera looked, so scenes become crowded there.
    let at = specimens[rng.below(specimens.len())].home + within(OFF_PLACE_M, rng);
    Placement::new(specimen, turn_deg, at, 0.0, None)
}

/// What stands on the table, can carry something and does not yet, with its top.
fn free_tops<'a>(placed: &[Placement<'a>]) -> Vec<(usize, &'a Top)> {
    let free_top = |(k, object): (usize, &Placement<'a>)| {
        let is_free = object.carrier.is_none() && placed.iter().all(|other| other.carrier != Some(k));
        object.specimen.top.as_ref().filter(|_| is_free).map(|top| (k, top))
    };
    placed.iter().enumerate().filter_map(free_top).collect()
}

/// Uniform in the square of this half side (m).
fn within(half_m: f64, rng: &mut Rng) -> DVec2 {
    let x = rng.range(-half_m..half_m);
    DVec2::new(x, rng.range(-half_m..half_m))
}

/// Whether it is not too far from its own place, stands on the table and keeps a gap from all that reaches as high, but for what carries it.
fn fits(next: &Placement<'_>, placed: &[Placement<'_>], table: &Table, gap_m: f64) -> bool {
    let is_clear = |(k, other): (usize, &Placement<'_>)| {
        next.carrier == Some(k)
            || !next.is_level_with(other)
            || next.footprint.gap_m(&other.footprint) >= gap_m
    };
    next.is_near_home() && table.outline.contains(&next.footprint) && placed.iter().enumerate().all(is_clear)
}
