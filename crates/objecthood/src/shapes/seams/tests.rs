//! Seams of painted boards.

use super::*;
use crate::objectness::outline::{ColorEvidence, SeamsAt, measure_outlines};
use crate::raster::Raster;
use crate::shapes::border::measure_by_depth;
use crate::surface::disparity::position;
use crate::surface::model::Basis;
use crate::surface::moments::Moments;
use crate::testing::kinect;

const SIZE: (usize, usize) = (100, 80);
const RED: [f32; 3] = [50.0, 50.0, 30.0];
const BLUE: [f32; 3] = [40.0, 10.0, -40.0];

/// A board that fills the image, 1 m before the camera: 190 mm x 150 mm, 1.9 mm a pixel. It is one facet.
fn board() -> (Facets, Raster<f32>) {
    let (width, height) = SIZE;
    let disparity = Raster::filled(width, height, 351.0_f32).unwrap();
    let pixels: Vec<u32> = (0..(width * height) as u32).collect();
    let model = Moments::of(&pixels, &disparity).fit(Basis::Plane).model;
    let segments = Segments::from_numbered(disparity.map(|_| 0), 1);
    (Facets { segments, models: vec![model], structure: 0, flats: Vec::new() }, disparity)
}

/// The board where `is_face` says so; elsewhere no facet, and something of this disparity (quanta).
fn outlined(is_face: &dyn Fn(usize, usize) -> bool, beside: f32) -> (Facets, Raster<f32>) {
    let (Facets { segments, models, .. }, disparity) = board();
    let labels = segments.labels();
    let is_face = |i: usize| is_face(i % SIZE.0, i / SIZE.0);
    let face = labels.with_data((0..labels.len()).map(|i| if is_face(i) { 0 } else { -1 }).collect());
    let seen = (0..labels.len()).map(|i| if is_face(i) { disparity[i] } else { beside }).collect();
    let segments = Segments::from_numbered(face, 1);
    (Facets { segments, models, structure: 0, flats: Vec::new() }, disparity.with_data(seen))
}

/// The seams of the board when the image is painted so, and its facets.
fn seams(paint: impl Fn(usize, usize) -> [f32; 3], params: &params::Seams) -> Option<(Cuts, Facets)> {
    let (facets, disparity) = board();
    seams_of(&facets, &disparity, paint, params)
}

/// The same of another board.
fn seams_of(
    facets: &Facets,
    disparity: &Raster<f32>,
    paint: impl Fn(usize, usize) -> [f32; 3],
    params: &params::Seams,
) -> Option<(Cuts, Facets)> {
    let lab = &LabImage::drawn(SIZE, paint);
    let (shapes, up) = (&Shapes { of_facet: vec![0; facets.segments.count()], count: 1 }, Some(DVec3::NEG_Y));
    let search = Search { facets, shapes, lab, space: &kinect(), disparity, params, up, size: SIZE };
    let partings = search.part_all();
    (!partings.is_empty()).then(|| Cuts::make(partings, facets, LEAST_PIECE_PX))
}

fn count(paint: impl Fn(usize, usize) -> [f32; 3]) -> usize {
    seams(paint, &params::Seams::default()).map_or(1, |(_, facets)| facets.segments.count())
}

#[test]
fn two_colors_that_meet_across_the_board_are_two_things() {
    for joint in [30, 50, 64] {
        let paint = |u: usize, _: usize| if u < joint { RED } else { BLUE };
        let (cuts, facets) = seams(paint, &params::Seams::default()).unwrap();
        let labels = facets.segments.labels();
        let wrong = (0..labels.len()).filter(|i| (labels[*i] != labels[0]) != (i % SIZE.0 >= joint)).count();
        assert!(wrong <= SIZE.1, "{wrong} pixels of a joint at {joint}");
        assert!(cuts.between(0, 1).is_some() && cuts.between(1, 1).is_none());
    }
    assert_eq!(count(|_, v| if v < 40 { RED } else { BLUE }), 2);
}

#[test]
fn three_boxes_in_a_row_are_three_things() {
    assert_eq!(count(|u, _| [RED, BLUE, [80.0, -20.0, 50.0]][(u / 34).min(2)]), 3);
}

#[test]
fn print_is_no_joint() {
    let within = |u: usize, v: usize| (20..60).contains(&u) && (20..60).contains(&v);
    assert_eq!(count(|u, v| if within(u, v) { RED } else { BLUE }), 1, "closed inside the face");
    assert_eq!(count(|u, _| if (40..60).contains(&u) { RED } else { BLUE }), 1, "comes back beyond a band");
    assert_eq!(count(|u, _| if u / 12 % 2 == 0 { RED } else { BLUE }), 1, "stripes");
    assert_eq!(count(|u, v| if u < 50 && v < 45 { RED } else { BLUE }), 1, "ends within the face");
}

#[test]
fn shading_and_the_same_color_are_no_joint() {
    let bluish_shadow = |u: usize, _: usize| if u < 50 { [50.0, 50.0, 28.0] } else { [64.0, 50.0, 20.0] };
    assert_eq!(count(bluish_shadow), 1);
    assert_eq!(count(|_, _| RED), 1);
    assert_eq!(count(|u, _| [30.0 + 0.4 * u as f32, RED[1], RED[2]]), 1, "light that falls off");
    assert_eq!(count(|u, _| [if u < 50 { 50.0 } else { 60.0 }, RED[1], RED[2]]), 1, "a pale shadow");
}

/// Grey boxes of another simulator were one: their colours are near each other, but never the same.
#[test]
fn even_colors_may_be_as_near_as_they_like_if_none_is_taken_for_the_other() {
    let (rose, pale) = ([50.0, 10.0, 0.0], [82.0, 0.0, 0.0]);
    assert_eq!(count(|u, _| if u < 50 { rose } else { pale }), 2);
    let spotted = |u: usize, v: usize| {
        if u >= 50 || (u.is_multiple_of(4) && v.is_multiple_of(4)) { pale } else { rose }
    };
    assert_eq!(count(spotted), 1, "a sixteenth of one side has the colour of the other");
}

/// Whether a seam is found in two faces that meet at row 40, of which the lower one leans back. The joint is the plane
/// that the upper one shows at column 50. One of `spots` cells beyond it has the colour of the other side.
fn is_joint_around_an_edge(spots: usize) -> bool {
    let (Facets { segments, mut models, .. }, mut disparity) = board();
    let is_lower = |i: usize| i >= 40 * SIZE.0;
    let quanta = |v: usize| 351.0 - 0.5 * v.saturating_sub(40) as f32;
    let lower: Vec<u32> = (0..SIZE.0 * SIZE.1).filter(|&i| is_lower(i)).map(|i| i as u32).collect();
    lower.iter().for_each(|&i| disparity.as_mut_slice()[i as usize] = quanta(i as usize / SIZE.0));
    models.push(Moments::of(&lower, &disparity).fit(Basis::Plane).model);
    let faces = (0..SIZE.0 * SIZE.1).map(|i| i32::from(is_lower(i))).collect();
    let segments = Segments::from_numbered(segments.labels().with_data(faces), 2);
    let facets = Facets { segments, models, structure: 0, flats: Vec::new() };
    let middle = kinect().camera().cx_px as f32;
    let paint = |u: usize, v: usize| {
        let is_beyond = (u as f32 - middle) * 351.0 / quanta(v) >= 50.0 - middle;
        let is_spot = (7 * (u / 2) + 3 * (v / 2)).is_multiple_of(spots);
        if is_beyond && !is_spot { BLUE } else { RED }
    };
    let lab = &LabImage::drawn(SIZE, paint);
    let shapes = &Shapes { of_facet: vec![0; 2], count: 1 };
    let (params, up) = (&params::Seams::default(), Some(DVec3::NEG_Y));
    let (facets, disparity, space) = (&facets, &disparity, &kinect());
    let search = Search { facets, shapes, lab, space, disparity, params, up, size: SIZE };
    !search.part_all().is_empty()
}

/// Flush boxes of another simulator, which shared a sixth of their colours, were one.
#[test]
fn colors_overlap_more_where_the_joint_goes_around_an_edge() {
    assert!(is_joint_around_an_edge(6), "a sixth of one side has the colour of the other");
    assert!(!is_joint_around_an_edge(3), "a third of it has");
    let one_face =
        |u: usize, v: usize| if u < 50 || (7 * (u / 2) + 3 * (v / 2)).is_multiple_of(6) { RED } else { BLUE };
    assert_eq!(count(one_face), 1, "there is one face only");
}

/// The faces of boxes of another simulator that were turned away from the light showed no change of colour.
#[test]
fn colors_differ_as_much_in_dim_light() {
    let halves = |lightness: f32| {
        move |u: usize, _: usize| if u < 50 { [lightness, -4.0, 0.0] } else { [lightness + 0.1, 7.0, 0.0] }
    };
    assert_eq!(count(halves(10.0)), 2);
    assert_eq!(count(halves(60.0)), 1);
}

/// A regression: a hard shadow on a white or coloured box was a joint.
#[test]
fn the_edge_of_a_hard_shadow_is_no_joint() {
    for lit in [[90.0, 0.0, 0.0], RED, [80.0, 40.0, 25.0]] {
        let dimmed = [0.7 * (lit[0] + 16.0) - 16.0, 0.7 * lit[1], 0.7 * lit[2]];
        assert_eq!(count(|u, _| if u < 50 { lit } else { dimmed }), 1, "{lit:?} at a third of the light");
    }
}

/// A regression: a box whose paint runs from one colour into another, made by another simulator, was four objects.
#[test]
fn a_gradient_is_no_joint() {
    let mixed = |share: f32| std::array::from_fn(|k| RED[k] + share * (BLUE[k] - RED[k]));
    assert_eq!(count(|u, _| mixed(u as f32 / SIZE.0 as f32)), 1, "all along the board");
    assert_eq!(count(|u, _| mixed((u as f32 / 30.0 - 1.0).clamp(0.0, 1.0))), 1, "over 30 px");
    let both = |u: usize, _: usize| if u < 50 { mixed(u as f32 / 150.0) } else { mixed(1.0) };
    assert_eq!(count(both), 2, "a joint beside a gradient");
}

#[test]
fn what_is_too_narrow_for_a_thing_is_not_cut_off() {
    assert_eq!(count(|u, _| if u < 4 { RED } else { BLUE }), 1, "8 mm from the end");
}

/// Stacked boxes whose fronts lie in one plane were one thing when their other faces, or a little of their colours, spoke against a seam.
#[test]
fn a_joint_at_which_the_outline_steps_at_both_ends_may_share_more_colors() {
    // A fifth of the upper box, away from the joint, has the colour of the lower one.
    let paint = |u: usize, v: usize| if v >= 40 || (v < 14 && (30..70).contains(&u)) { BLUE } else { RED };
    let pieces = |is_face: &dyn Fn(usize, usize) -> bool| {
        let (facets, disparity) = outlined(is_face, 351.0);
        let cut = seams_of(&facets, &disparity, paint, &params::Seams::default());
        cut.map_or(1, |(_, facets)| facets.segments.count())
    };
    assert_eq!(pieces(&|u, v| v >= 40 || (15..85).contains(&u)), 2);
    assert_eq!(pieces(&|_, _| true), 1, "no step: it may be print");
    assert_eq!(pieces(&|u, v| v >= 40 || u < 80), 1, "one step is not enough for so many colours");
    assert_eq!(
        pieces(&|u, v| v >= 40 || u >= 15),
        1,
        "a step at one end: what is before the face may hide its corner"
    );
    let slanting = |u: usize, v: usize| (40 - v / 2..60 + v / 2).contains(&u);
    assert_eq!(pieces(&slanting), 1, "a gable");
}

/// A box on a longer one, flush with its front and with one of its ends, stands in many trays and piles.
#[test]
fn a_joint_at_which_the_outline_steps_far_at_one_end_may_be_less_clear() {
    // Less clear than red on blue: a tenth of the upper box in the lower one's colour is too much for a joint without a step.
    let pale = [50.0, 50.0, 2.0];
    let paint = |u: usize, v: usize| if v >= 40 || (v < 10 && (10..42).contains(&u)) { pale } else { RED };
    let pieces = |is_face: &dyn Fn(usize, usize) -> bool, beside: f32| {
        let (facets, disparity) = outlined(is_face, beside);
        let cut = seams_of(&facets, &disparity, paint, &params::Seams::default());
        cut.map_or(1, |(_, facets)| facets.segments.count())
    };
    let (far, near) = (200.0, 420.0);
    let up_to = |column: usize| move |u: usize, v: usize| v >= 40 || u < column;
    assert_eq!(pieces(&up_to(80), far), 2);
    assert_eq!(pieces(&up_to(100), far), 1, "no step");
    assert_eq!(pieces(&up_to(92), far), 1, "15 mm: noise may step so far at one end");
    assert_eq!(pieces(&up_to(80), near), 1, "something nearer may hide a part of the upper box");
    let strip = |u: usize, v: usize| v >= 40 || v >= 31 && u < 80;
    assert_eq!(pieces(&strip, far), 1, "too low to show that it does not slant");
}

/// Things in a tray stand flush with its wall, and higher than it: their common face has a notch between them.
#[test]
fn a_joint_at_which_the_outline_has_a_notch_may_be_less_clear() {
    let pale = [50.0, 50.0, 2.0];
    let paint = |u: usize, v: usize| if v >= 40 || (v < 10 && u < 26) { pale } else { RED };
    let pieces = |notch: std::ops::Range<usize>, beside: f32| {
        let (facets, disparity) = outlined(&|u, v| v >= 40 || !notch.contains(&u), beside);
        let cut = seams_of(&facets, &disparity, paint, &params::Seams::default());
        cut.map_or(1, |(_, facets)| facets.segments.count())
    };
    let (far, same, near) = (200.0, 351.0, 420.0);
    assert_eq!(pieces(40..60, far), 3, "the wall and two things");
    assert_eq!(pieces(40..50, far), 1, "20 mm");
    assert_eq!(pieces(40..60, same), 1, "the face goes on there");
    assert_eq!(pieces(40..60, near), 1, "something nearer hides it");
    assert_eq!(pieces(40..60, f32::NAN), 1, "it may be a hole in what is measured");
}

/// One pixel that stuck out beyond the narrower side made its end a notch, which needs no height.
#[test]
fn a_stray_pixel_makes_no_notch() {
    let pale = [50.0, 50.0, 2.0];
    let paint = |u: usize, v: usize| if v >= 40 || (v < 10 && (10..42).contains(&u)) { pale } else { RED };
    let is_face = |u: usize, v: usize| v >= 40 || v >= 31 && u < 80 || (u, v) == (99, 36);
    let (facets, disparity) = outlined(&is_face, 200.0);
    assert!(seams_of(&facets, &disparity, paint, &params::Seams::default()).is_none());
}

/// What is left of a facet on one side of a seam.
#[test]
fn parts_that_do_not_hang_together_are_facets_each() {
    let pixels = |places: &[usize]| -> Vec<BodyPixel> {
        let pixel = |&i: &usize| BodyPixel { i: i as u32, facet: 0, color: RED, point: DVec3::Z };
        places.iter().map(pixel).collect()
    };
    let pieces = |places: &[usize], least_px| -> Vec<Vec<u32>> {
        let pieces = connected_pieces(&pixels(places), 5, least_px);
        pieces.iter().map(|piece| piece.iter().map(|p| p.i).collect()).collect()
    };
    assert_eq!(pieces(&[0, 1, 2, 8], 1), [vec![0, 1, 2], vec![8]], "they touch at a corner only");
    assert_eq!(pieces(&[3, 4, 5, 6], 1).len(), 2, "a row ends between them");
    assert_eq!(pieces(&[0, 1, 5, 13], 2), [vec![0, 1, 5, 13]], "a speck stays with the rest");
    assert_eq!(connected_pieces(&pixels(&[0, 1, 3]), 1, 1).len(), 2, "an image of one column");
}

/// Depth may end a facet just where two things meet: then no facet showed both sides of their joint.
#[test]
fn facets_of_one_plane_are_one_face() {
    let (board, disparity) = board();
    let labels = disparity.with_data((0..disparity.len()).map(|i| i32::from(i % SIZE.0 >= 50)).collect());
    let models = vec![board.models[0]; 2];
    let facets = Facets { segments: Segments::from_numbered(labels, 2), models, ..board };
    let paint = |u: usize, _: usize| if u < 50 { RED } else { BLUE };
    let (cuts, cut) = seams_of(&facets, &disparity, paint, &params::Seams::default()).unwrap();
    assert_eq!(cut.segments.count(), 2);
    assert!(cuts.between(0, 1).is_some());
}

/// Depth that is measured over windows reaches over the edge of a near thing: the band there has the colour of what lies behind.
#[test]
fn depth_that_reaches_over_the_edge_is_not_cut_off() {
    let pieces = |paint: fn(usize) -> [f32; 3]| {
        let (facets, disparity) = outlined(&|u, _| u < 78, 351.0);
        let cut = seams_of(&facets, &disparity, |u, _| paint(u), &params::Seams::default());
        cut.map_or(1, |(_, facets)| facets.segments.count())
    };
    assert_eq!(pieces(|u| if u < 66 { RED } else { BLUE }), 1, "the band goes on behind the board");
    assert_eq!(pieces(|u| if (66..78).contains(&u) { BLUE } else { RED }), 2, "it ends with the board");
    assert_eq!(pieces(|u| if u < 40 { RED } else { BLUE }), 2, "it is wider than depth reaches");
}

#[test]
fn a_seam_outvotes_the_flat_border_that_it_cuts() {
    let (cuts, facets) = seams(|u, _| if u < 50 { RED } else { BLUE }, &params::Seams::default()).unwrap();
    let borders = measure_by_depth(&facets, &board().1, &kinect(), &params::Border::default());
    let joined = |borders: &RegionGraph<BorderEvidence>, params: &params::Contraction| {
        contract(&sum_votes(borders, 0, params)).count
    };
    let votes = params::Contraction::default();
    assert_eq!(joined(&borders, &votes), 1, "depth alone sees one board");
    let marked = cuts.mark(borders);
    assert_eq!(joined(&marked, &votes), 2);
    assert_eq!(joined(&marked, &params::Contraction { seam_weight: 0.0, ..votes }), 1);
}

#[test]
fn the_parameters_decide() {
    let default = params::Seams::default();
    let torn = |u: usize, v: usize| if u < 50 || v < 32 { RED } else { BLUE };
    assert!(seams(torn, &default).is_none());
    assert!(seams(torn, &params::Seams { cross_share: 0.4, color_overlap: 1.0, ..default }).is_some());
}

#[test]
fn a_seam_parts_two_things_as_clearly_as_a_step() {
    let paint = |u: usize, _: usize| if u < 50 { RED } else { BLUE };
    let (cuts, facets) = seams(paint, &params::Seams::default()).unwrap();
    let disparity = board().1;
    let point = |i: usize| kinect().point_m(position(i, SIZE.0), disparity[i].into()).map(|x| x as f32);
    let points_m = disparity.with_data((0..disparity.len()).map(point).collect());
    let normals = disparity.map(|_| [0.0, 0.0, -1.0]);
    let separation = |seams| {
        let color = ColorEvidence { lab: None, seams };
        let params = params::Contraction::default();
        let outlines = measure_outlines(&facets.segments, 0, &points_m, &normals, &kinect(), &params, color);
        [0, 1].map(|half| outlines[half].separation())
    };
    let seams = SeamsAt { facets: &facets.segments, cuts: &cuts };
    assert_eq!(separation(Some(seams)), [1.0; 2]);
    assert!(separation(None).iter().all(|&halves| halves < 0.2), "one even board");
}
