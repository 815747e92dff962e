use super::*;
use crate::color::image::LabImage;
use crate::regions::{RegionEdge, Segments};
use crate::surface::model::Basis;
use crate::surface::moments::Moments;
use crate::testing::space;

const WIDTH: usize = 80;
const HEIGHT: usize = 60;
const RED: [f32; 3] = [50.0, 60.0, 40.0];
const BLUE: [f32; 3] = [30.0, 10.0, -60.0];

/// Two walls that meet at the upright line through the principal point, each turned by half of `fold_deg`; the right
/// one stands `step_m` farther back. `scale`: the focal length over 525 px.
struct Walls {
    facets: Facets,
    disparity: Raster<f32>,
    space: DisparitySpace,
}

impl Walls {
    fn new(fold_deg: f64, step_m: f64, scale: usize) -> Self {
        let (width, height) = (WIDTH * scale, HEIGHT * scale);
        let f = 525.0 * scale as f64;
        let space = space([f, f], [width as f64 / 2.0 - 0.5, height as f64 / 2.0 - 0.5]);
        let (sin, cos) = libm::sincos((fold_deg / 2.0).to_radians());
        let is_right = |i: usize| i % width >= width / 2;
        let depth_m = |i: usize| {
            let side = if is_right(i) { 1.0 } else { -1.0 };
            let ray = DVec3::from(space.camera().ray((i % width) as f64, (i / width) as f64));
            // Through (0, 0, 1 + step), its normal leaning to its own side when the fold is a ridge.
            let normal = DVec3::new(side * sin, 0.0, -cos);
            let foot_m = 1.0 + if is_right(i) { step_m } else { 0.0 };
            (normal.z * foot_m / normal.dot(ray)) as f32
        };
        let depth_m = Raster::from_vec(width, height, (0..width * height).map(depth_m).collect()).unwrap();
        let disparity = space.disparity(&depth_m);
        let of =
            |right: bool| (0..(width * height) as u32).filter(|&i| is_right(i as usize) == right).collect();
        let pixels: [Vec<u32>; 2] = [of(false), of(true)];
        let models = pixels.map(|pixels| Moments::of(&pixels, &disparity).fit(Basis::Quadratic).model);
        let labels = depth_m.with_data((0..width * height).map(|i| i32::from(is_right(i))).collect());
        let facets = Facets {
            segments: Segments::from_numbered(labels, 2),
            models: models.to_vec(),
            structure: 0,
            flats: vec![],
        };
        Self { facets, disparity, space }
    }

    fn seen(&self, step_depth_m: f64) -> BorderEvidence {
        let params = params::Border { step_depth_m, ..Default::default() };
        let graph = measure_by_depth(&self.facets, &self.disparity, &self.space, &params);
        let [edge] = graph.edges() else { panic!("one border: {graph:?}") };
        edge.evidence.clone()
    }
}

/// The length of the border (m).
fn border_m(evidence: &BorderEvidence) -> f64 {
    evidence.folds.iter().map(|fold| fold.length_m).sum()
}

/// The true length of the border at 1 m (m).
const TRUE_M: f64 = HEIGHT as f64 / 525.0;

#[test]
fn the_angle_and_the_length_of_a_fold_are_measured() {
    for scale in [1, 2] {
        for fold_deg in [90.0, 40.0, 5.0, 0.0, -5.0, -40.0, -90.0] {
            let evidence = Walls::new(fold_deg, 0.0, scale).seen(0.013);
            assert_eq!(evidence.step_m, 0.0, "{fold_deg}");
            for fold in &evidence.folds {
                // The ridge term pulls the slope of a narrow side to the facet's own; here both are equal.
                assert!((fold.angle_deg - fold_deg).abs() < 1.0, "{fold_deg} at {scale}: {fold:?}");
            }
            let length_m = border_m(&evidence);
            assert!((length_m / TRUE_M - 1.0).abs() < 0.05, "{fold_deg} at {scale}: {length_m}");
        }
    }
}

#[test]
fn a_deep_step_hides_something() {
    for fold_deg in [0.0, 60.0] {
        let evidence = Walls::new(fold_deg, 0.05, 1).seen(0.013);
        assert!(evidence.folds.is_empty(), "{fold_deg}: {evidence:?}");
        assert!((evidence.step_m / TRUE_M - 1.0).abs() < 0.08, "{fold_deg}: {}", evidence.step_m);
    }
}

#[test]
fn a_small_step_at_a_ridge_is_a_torn_ridge() {
    // 16 mm are 5.6 quanta: a step, but with these parameters it hides nothing.
    let torn = Walls::new(60.0, 0.016, 1).seen(0.02);
    assert!(torn.step_m == 0.0 && (border_m(&torn) / TRUE_M - 0.5).abs() < 0.05, "{torn:?}");
    assert!(torn.folds.iter().all(|fold| fold.angle_deg > 50.0), "{torn:?}");
    for fold_deg in [0.0, -60.0] {
        let step = Walls::new(fold_deg, 0.016, 1).seen(0.02);
        assert!(step.folds.is_empty() && (step.step_m / TRUE_M - 1.0).abs() < 0.05, "{fold_deg}: {step:?}");
    }
}

#[test]
fn what_noise_explains_is_no_step() {
    // 6 mm are 2.1 quanta: within the noise, so no step, even where such a depth would hide something.
    let level = Walls::new(60.0, 0.006, 1).seen(0.001);
    assert!(level.step_m == 0.0 && (border_m(&level) / TRUE_M - 1.0).abs() < 0.05, "{level:?}");
    // 13 mm are 4.6 quanta: a step, unless the surfaces turn so much that sideways noise makes it.
    assert!(Walls::new(0.0, 0.013, 1).seen(0.02).folds.is_empty());
    let folded = Walls::new(60.0, 0.013, 1).seen(0.02);
    assert!(folded.step_m == 0.0 && (border_m(&folded) / TRUE_M - 1.0).abs() < 0.05, "{folded:?}");
}

#[test]
fn two_surfaces_of_the_structure_have_no_border() {
    let mut walls = Walls::new(90.0, 0.0, 1);
    let count = |walls: &Walls| {
        let params = params::Border::default();
        measure_by_depth(&walls.facets, &walls.disparity, &walls.space, &params).edges().len()
    };
    walls.facets.structure = 1;
    assert_eq!(count(&walls), 1, "one surface of the structure and a facet have one");
    walls.facets.structure = 2;
    assert_eq!(count(&walls), 0);
}

#[test]
fn a_vote_is_in_metres_of_border() {
    let params = params::Contraction {
        reflex_offset_deg: 12.0,
        full_vote_deg: 15.0,
        occlusion_weight: 0.15,
        seam_weight: 2.0,
        color_change_weight: 0.4,
    };
    let vote = |folds: &[(f64, f64)], step_m: f64| {
        let folds = folds.iter().map(|&(angle_deg, length_m)| Fold { angle_deg, length_m }).collect();
        BorderEvidence { folds, step_m, ..Default::default() }.vote_m(&params)
    };
    for (angle_deg, share) in
        [(90.0, 1.0), (3.0, 1.0), (0.0, 0.8), (-12.0, 0.0), (-19.5, -0.5), (-90.0, -1.0)]
    {
        assert!((vote(&[(angle_deg, 0.2)], 0.0) - 0.2 * share).abs() < 1e-12, "{angle_deg}");
    }
    assert!((vote(&[(90.0, 0.1), (-90.0, 0.3)], 0.2) - (0.1 - 0.3 - 0.03)).abs() < 1e-12);
    assert_eq!(vote(&[], 0.0), 0.0);
    let change = BorderEvidence { color_change_m: 0.5, seam_m: 0.1, ..Default::default() };
    assert!((change.vote_m(&params) + 0.2 + 0.2).abs() < 1e-12);
}

#[test]
fn a_shallow_valley_parts_two_colours_and_print_stays_whole() {
    let vote_m = |fold_deg: f64, right: [f32; 3]| {
        let Walls { facets, disparity, space } = Walls::new(fold_deg, 0.0, 1);
        let lab = LabImage::drawn((WIDTH, HEIGHT), |u, _| if u < WIDTH / 2 { RED } else { right });
        let borders = measure_by_depth(&facets, &disparity, &space, &params::Border::default());
        let borders = mark_color_changes(borders, &FacetColors::of(&facets, &lab, &space));
        borders.edges()[0].evidence.vote_m(&params::Contraction::default())
    };
    assert!(vote_m(-8.0, RED) > 0.0 && vote_m(-8.0, BLUE) < 0.0);
    assert!(vote_m(-5.0, BLUE) > 0.0 && vote_m(-7.0, BLUE) < 0.0, "half way at 6 degrees");
    assert!(vote_m(0.0, BLUE) > 0.0, "one face with print");
    assert!(vote_m(-20.0, RED) < 0.0, "depth is sure by itself");
}

#[test]
fn small_facets_and_structure_have_no_colour() {
    // The first facet has so many pixels.
    let color_change_m = |first_px: usize, structure: usize| {
        let labels = (0..WIDTH * HEIGHT).map(|i| i32::from(i >= first_px)).collect();
        let segments = Segments::from_numbered(Raster::from_vec(WIDTH, HEIGHT, labels).unwrap(), 2);
        let facets = Facets { segments, models: Vec::new(), structure, flats: Vec::new() };
        let lab = LabImage::drawn((WIDTH, HEIGHT), |u, v| if v * WIDTH + u < first_px { RED } else { BLUE });
        let folds = vec![Fold { angle_deg: 0.0, length_m: 0.1 }];
        let evidence = BorderEvidence { folds, step_m: 0.2, ..Default::default() };
        let edge = RegionEdge { a: SegmentId(0), b: SegmentId(1), evidence };
        let borders = RegionGraph::from_sorted(2, vec![edge]);
        let space = space([525.0; 2], [0.0; 2]);
        mark_color_changes(borders, &FacetColors::of(&facets, &lab, &space)).edges()[0]
            .evidence
            .color_change_m
    };
    assert_eq!(color_change_m(160, 0), 0.1, "the folds, not the steps");
    assert_eq!([59, 60].map(|first_px| color_change_m(first_px, 0)), [0.0, 0.1]);
    assert_eq!(color_change_m(160, 1), 0.0);
}
