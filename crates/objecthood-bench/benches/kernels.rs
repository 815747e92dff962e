//! The kernels on one synthetic frame of 640 x 480, on one thread.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use objecthood::attitude::Attitude;
use objecthood::oversegment::graph::{PixelGraph, Unmeasured};
use objecthood::oversegment::links::Links;
use objecthood::oversegment::smoothing::smooth;
use objecthood::oversegment::structure::find_structure;
use objecthood::oversegment::watershed::{find_seeds, flood};
use objecthood::surface::curvature::measure_curvature;
use objecthood::surface::normals::measure_normals;
use objecthood::surface::plane_fit::fit_planes;
use objecthood::surface::surfaces::{Surfaces, find_surfaces};
use objecthood::surface::window_choice::choose_windows;
use objecthood::{Frame, Params, Pipeline};
use objecthood_bench::graph::{color_alone, graph_segmentation};
use objecthood_scene::{Family, Sensor, generate, render};
use rayon::ThreadPoolBuilder;

/// The scene of `objecthood demo`, which has colour.
#[expect(clippy::expect_used, reason = "a fixed scene of a known camera")]
fn frame() -> Frame {
    render(&generate(Family::Tabletop, 34), Sensor::Kinect).expect("the demo's scene").frame
}

fn paper(c: &mut Criterion) {
    let (frame, params) = (frame(), Params::default());
    let points = frame.points_m();
    let _buffers = Pipeline::default();
    let per_pixel = measure_normals(&points, &params.normals);
    let mut group = c.benchmark_group("paper");
    group.sample_size(20);
    group.bench_function("normals", |b| b.iter(|| measure_normals(black_box(&points), &params.normals)));
    group.bench_function("curvature", |b| {
        b.iter(|| measure_curvature(black_box(&per_pixel), &params.curvature));
    });
    if let Some(color) = frame.color() {
        let smoothed = smooth(color, frame.depth_m(), &params.smoothing);
        group.bench_function("smoothing", |b| {
            b.iter(|| smooth(black_box(color), frame.depth_m(), &params.smoothing));
        });
        group.bench_function("graph: edges and sort", |b| {
            let (sensor, graph) = (&params.sensor, &params.graph);
            b.iter(|| PixelGraph::new(black_box(&frame), Some(&smoothed), Unmeasured::Apart, sensor, graph));
        });
        let (borders, color_alone) = (color.map(|_| false), color_alone());
        group.bench_function("graph segmentation of colour alone", |b| {
            b.iter(|| graph_segmentation(black_box(&frame), &borders, &color_alone));
        });
    }
    group.finish();
}

fn context(c: &mut Criterion) {
    let (frame, params) = (frame(), Params::default());
    let surfaces = find_surfaces(&frame, &params.sensor, &params.local_fit);
    let Surfaces { space, disparity, fits, orientation: oriented, .. } = &surfaces;
    let radius_px = space.length_px(params.local_fit.radius_px);
    let attitude = Attitude::of(&frame, &params.gravity);
    let planes = find_structure(frame.depth_m(), &surfaces, &attitude, &params.structure);
    let links = Links::new(disparity, &oriented.slope, &planes.labels, space, &params.watershed);

    let mut group = c.benchmark_group("context");
    group.sample_size(20);
    group.bench_function("plane fits", |b| {
        b.iter(|| fit_planes(black_box(disparity), radius_px));
    });
    group.bench_function("orientation", |b| {
        b.iter(|| choose_windows(black_box(disparity), fits, space, &params.local_fit));
    });
    group.bench_function("structure", |b| {
        b.iter(|| find_structure(black_box(frame.depth_m()), &surfaces, &attitude, &params.structure));
    });
    group.bench_function("watershed", |b| {
        b.iter(|| {
            let seeds = find_seeds(black_box(&fits.residual), &links, space, &params.watershed);
            flood(&fits.residual, &seeds, &links)
        });
    });
    group.finish();
}

/// One thread for all, so that a kernel's figure is its work.
#[expect(clippy::expect_used, reason = "nothing is measured without a thread")]
fn on_one_thread(c: &mut Criterion) {
    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("nobody else has made a pool");
    paper(c);
    context(c);
}

criterion_group!(kernels, on_one_thread);
criterion_main!(kernels);
