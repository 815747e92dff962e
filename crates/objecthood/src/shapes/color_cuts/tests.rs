use super::*;
use crate::surface::model::Model;
use crate::testing::kinect;

const SIZE: (usize, usize) = (60, 40);
/// Disparity quantum (1/m).
const KINECT_QUANTUM: f64 = 0.00285;
const RED: [f32; 3] = [50.0, 60.0, 40.0];
const BLUE: [f32; 3] = [30.0, 10.0, -60.0];

/// The facets that are left of one that fills the image: its disparity (quanta) and colour at each place.
fn cut(at: impl Fn(f64, f64) -> f64, color: impl Fn(usize, usize) -> [f32; 3]) -> Facets {
    cut_seen(at, color, |_, _| true)
}

/// The same if the facet has these pixels only.
fn cut_seen(
    at: impl Fn(f64, f64) -> f64,
    color: impl Fn(usize, usize) -> [f32; 3],
    is_seen: impl Fn(usize, usize) -> bool,
) -> Facets {
    let (width, height) = SIZE;
    let seen = (0..width * height).map(|i| at((i % width) as f64, (i / width) as f64) as f32);
    let disparity = Raster::from_vec(width, height, seen.collect()).unwrap();
    let pixels: Vec<u32> =
        (0..width * height).filter(|i| is_seen(i % width, i / width)).map(|i| i as u32).collect();
    let model = Moments::of(&pixels, &disparity).fit(Basis::Quadratic).model;
    let labels = (0..width * height).map(|i| if is_seen(i % width, i / width) { 0 } else { -1 });
    let segments = Segments::from_numbered(Raster::from_vec(width, height, labels.collect()).unwrap(), 1);
    let facets = Facets { segments, models: vec![model], structure: 0, flats: Vec::new() };
    let (lab, space) = (LabImage::drawn(SIZE, color), kinect());
    let search = Search { lab: &lab, disparity: &disparity, space: &space, least_px: LEAST_PX };
    search.cut(facets, &params::ColorCuts::default())
}

/// A valley of 6 quanta a column to each side, in column 30.
fn valley(u: f64, _v: f64) -> f64 {
    300.0 + 6.0 * (u - 29.5).abs()
}

fn red_and_blue(u: usize, _v: usize) -> [f32; 3] {
    if u < 30 { RED } else { BLUE }
}

#[test]
fn a_valley_between_two_colours_parts_two_facets() {
    let facets = cut(valley, red_and_blue);
    assert_eq!((facets.segments.count(), facets.models.len()), (2, 2));
    for i in 0..SIZE.0 * SIZE.1 {
        let left = i % SIZE.0 < 30;
        assert_eq!(facets.segments.at(i) == facets.segments.at(0), left, "pixel {i}");
    }
    let model: &Model = &facets.models[facets.segments.at(SIZE.0 - 1).unwrap().index()];
    assert!((model.value([50.0, 20.0]) - valley(50.0, 20.0)).abs() < 0.1, "each has its own surface");
}

#[test]
fn below_print_the_surface_goes_on() {
    assert_eq!(cut(|u, _| 300.0 + 0.2 * u, red_and_blue).segments.count(), 1);
    assert_eq!(cut(|u, _| 300.0 - 0.02 * (u - 30.0).powi(2), red_and_blue).segments.count(), 1, "a cylinder");
}

#[test]
fn the_edge_of_a_painted_box_is_no_valley() {
    assert_eq!(cut(|u, v| 600.0 - valley(u, v), red_and_blue).segments.count(), 1);
}

#[test]
fn a_valley_of_one_colour_is_left_to_other_rules() {
    assert_eq!(cut(valley, |_, _| RED).segments.count(), 1);
}

/// Letters and stripes are many parts.
#[test]
fn many_parts_are_print() {
    assert_eq!(cut(valley, |u, _| if u / 10 % 2 == 0 { RED } else { BLUE }).segments.count(), 1);
}

/// A ball in a bowl: the colour of the bowl lies all around that of the ball.
#[test]
fn what_another_colour_surrounds_is_a_facet_of_its_own() {
    let middle = |u: f64, v: f64| ((u - 30.0).powi(2) + (v - 20.0).powi(2)).sqrt();
    let facets = cut(
        |u, v| 300.0 + 6.0 * (middle(u, v) - 12.0).abs(),
        |u, v| if middle(u as f64, v as f64) < 12.0 { RED } else { BLUE },
    );
    assert_eq!(facets.segments.count(), 2);
    assert_ne!(facets.segments.at(20 * SIZE.0 + 30), facets.segments.at(0));
}

/// A regression: a pixel that touches its facet at a corner only stopped every cut.
#[test]
fn a_crumb_of_a_facet_does_not_stop_a_cut() {
    let is_seen = |u: usize, v: usize| v >= 3 || (u, v) == (10, 1);
    let facets = cut_seen(valley, red_and_blue, is_seen);
    assert_eq!(facets.segments.count(), 2);
}

/// Where nothing is measured between two areas, colour decides.
#[test]
fn areas_that_do_not_touch_are_one_facet_unless_their_colours_differ() {
    let is_seen = |u: usize, _: usize| !(25..35).contains(&u);
    let left = |color: fn(usize, usize) -> [f32; 3]| cut_seen(valley, color, is_seen).segments.count();
    assert_eq!([left(|_, _| RED), left(red_and_blue)], [1, 2]);
    let red_beside_both = |u: usize, v: usize| if v < 20 || (25..35).contains(&u) { RED } else { BLUE };
    assert_eq!(left(red_beside_both), 1, "the surface goes on from red to blue");
}

#[test]
fn a_gentle_valley_is_noise() {
    // Depths at 1 m, where a column is 1.9 mm wide: two sides that are turned by so many degrees together.
    let folded = |degrees: f64| {
        let rise = libm::tan((degrees / 2.0).to_radians()) / 525.0;
        let at = move |u: f64, _| 1.0 / (KINECT_QUANTUM * (1.0 - rise * (u - 29.5).abs()));
        cut(at, red_and_blue).segments.count()
    };
    assert_eq!([folded(14.0), folded(24.0)], [1, 2]);
}
