use super::*;
use crate::attitude::Attitude;
use crate::camera::Camera;
use crate::check::Check;
use crate::facets::find_facets;
use crate::frame::Frame;
use crate::oversegment::linked::flood_superpixels;
use crate::oversegment::structure::find_structure;
use crate::params::Params;
use crate::raster::Raster;
use crate::surface::surfaces::find_surfaces;

const SIZE: (usize, usize) = (320, 240);
const TABLE: [u8; 3] = [150, 110, 80];
const SHEET: [u8; 3] = [230, 230, 235];
const SHADE: [u8; 3] = [90, 66, 48];

/// A table 0.8 m below a camera, on which a rectangle of 60 x 40 px rises (m) and has a colour; the flat things on it.
fn flats(rise_m: f32, color: Option<[u8; 3]>) -> (Vec<Flat>, Vec<usize>) {
    let is_in = |i: usize| (120..180).contains(&(i % SIZE.0)) && (100..140).contains(&(i / SIZE.0));
    let pixels = SIZE.0 * SIZE.1;
    let depth = (0..pixels).map(|i| if is_in(i) { 0.8 - rise_m } else { 0.8 }).collect();
    let depth_m = Raster::from_vec(SIZE.0, SIZE.1, depth).unwrap();
    let colors = color.map(|color| {
        let seen = (0..pixels).map(|i| if is_in(i) { color } else { TABLE }).collect();
        Raster::from_vec(SIZE.0, SIZE.1, seen).unwrap()
    });
    let frame = Frame::new(depth_m, colors, Camera::new(262.0, 262.0, 159.5, 119.5).unwrap()).unwrap();
    let params = Params::default();
    let surfaces = find_surfaces(&frame, &params.sensor, &params.local_fit);
    let attitude = Attitude::of(&frame, &params.gravity);
    let structure = find_structure(frame.depth_m(), &surfaces, &attitude, &params.structure);
    let superpixels = flood_superpixels(&surfaces, &structure, &params.watershed);
    let facets = find_facets(&surfaces, &structure, &superpixels, &params.merging, &params.refinement);
    let found = find_flats(facets, &surfaces, &structure, FlatParams::of(&params));
    let last = found.flats.last().map(|flat| flat.facet.index());
    let pixels = found.segments.members().filter(|&(_, facet)| Some(facet) == last).map(|(i, _)| i);
    (found.flats.clone(), pixels.collect())
}

#[test]
fn a_sheet_of_another_color_is_a_thing_and_its_shadow_is_not() {
    let (sheet, pixels) = flats(0.0, Some(SHEET));
    assert_eq!(sheet.len(), 1);
    assert!(!sheet[0].is_proven && sheet[0].checks.iter().all(Check::holds));
    assert!((2300..2600).contains(&pixels.len()), "{}", pixels.len());
    assert!(flats(0.0, Some(SHADE)).0.is_empty(), "the table in less light");
    assert!(flats(0.0, Some(TABLE)).0.is_empty());
}

#[test]
fn a_rise_is_proof_whatever_the_color() {
    for color in [None, Some(TABLE), Some(SHADE), Some(SHEET)] {
        let (book, pixels) = flats(0.005, color);
        assert_eq!(book.len(), 1, "{color:?}");
        assert!(book[0].is_proven && (2200..2600).contains(&pixels.len()), "{color:?} {}", pixels.len());
    }
    assert!(flats(0.0005, None).0.is_empty(), "less than noise");
    assert!(flats(0.0, None).0.is_empty());
}
