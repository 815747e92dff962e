//! Stop after the second stage: the smooth faces that a scene is made of, as planes.
//!
//! `cargo run --release -p objecthood --example 03_facets_only`

mod world;

use objecthood::Params;
use objecthood::attitude::Attitude;
use objecthood::facets::find_facets;
use objecthood::oversegment::linked::flood_superpixels;
use objecthood::oversegment::structure::find_structure;
use objecthood::surface::surfaces::find_surfaces;
use world::{Solid, snapshot};

#[expect(clippy::print_stdout, reason = "an example talks to its reader")]
pub(crate) fn main() -> objecthood::Result<()> {
    let frame = snapshot(&[Solid {
        base_m: [0.0, 0.0, 0.0],
        size_m: [0.18, 0.14, 0.12],
        yaw_deg: 25.0,
        color: [180, 40, 30],
    }]);
    let params = Params::default();

    let surfaces = find_surfaces(&frame, &params.sensor, &params.local_fit);
    let attitude = Attitude::of(&frame, &params.gravity);
    let structure = find_structure(frame.depth_m(), &surfaces, &attitude, &params.structure);
    let superpixels = flood_superpixels(&surfaces, &structure, &params.watershed);
    let facets = find_facets(&surfaces, &structure, &superpixels, &params.merging, &params.refinement);

    let count = facets.segments.count();
    println!("{count} facets; the first {} are structure, here the table", facets.structure);
    for facet in 0..count {
        let size_px = facets.segments.labels().as_slice().iter().filter(|&&l| l == facet as i32).count();
        println!("facet {facet}: {size_px} pixels");
    }
    Ok(())
}
