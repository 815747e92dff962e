//! Every method, stage and kernel on one frame after the other.

use std::alloc::System;
use std::path::Path;

use anyhow::{Context, Result};
use objecthood::surface::disparity::DisparitySpace;
use objecthood::surface::normals::measure_normals;
use objecthood::surface::plane_fit::fit_planes;
use objecthood::surface::window_choice::choose_windows;
use objecthood::{Frame, Method, Params, Pipeline, Raster};
use rayon::{ThreadPool, ThreadPoolBuilder};
use stats_alloc::{Region, StatsAlloc};

use crate::figure::{Figure, Spent, timed};
use crate::graph::{color_alone, flat_frame, graph_segmentation};
use crate::laps::Laps;
use crate::normals::{median_angle_deg, table};
use crate::peer::Peer;

/// The methods and their names.
pub const METHODS: [(&str, Method); 2] = [("context", Method::Context), ("paper", Method::Paper)];

/// A frame and what it is called.
pub struct Named {
    /// Its file without folder and ending.
    pub name: String,
    /// What the camera saw.
    pub frame: Frame,
}

/// Reads a frame.
///
/// # Errors
/// When the file cannot be read.
pub fn open(file: &Path) -> Result<Named> {
    let capture = objecthood_io::open_frame(file, &objecthood_io::Given::default())?;
    let name = file.file_stem().context("a file without a name")?.to_string_lossy().into_owned();
    Ok(Named { name, frame: capture.frame })
}

/// Measures frames.
pub struct Bench<'a> {
    /// One pool for each number of threads, in the order of their turns.
    pools: Vec<(usize, ThreadPool)>,
    /// The one in which kernels run.
    one: ThreadPool,
    allocator: &'a StatsAlloc<System>,
    peer: Option<Peer>,
    /// As a stream of frames keeps it.
    pipeline: Pipeline,
}

impl<'a> Bench<'a> {
    /// With pools of 1 and 2 threads; `allocator` counts what the whole program asks for.
    ///
    /// # Errors
    /// When the threads cannot be had.
    pub fn new(allocator: &'a StatsAlloc<System>, peer: Option<Peer>) -> Result<Self> {
        Ok(Self { pools: pools()?, one: pool(1)?, allocator, peer, pipeline: Pipeline::default() })
    }

    /// Both methods on 1 and 2 threads, with all stages; kernels; and the peer, all on this frame.
    ///
    /// # Errors
    /// When a method refuses the frame or the peer has ended.
    pub fn measure(&mut self, named: &Named, figures: &mut Vec<Figure>) -> Result<()> {
        let Named { name, frame } = named;
        let pipeline = &mut self.pipeline;
        for (threads, pool) in &self.pools {
            for (method_name, method) in METHODS {
                let params = Params { method, ..Params::default() };
                let before = Region::new(self.allocator);
                let mut laps = Laps::start();
                pipeline.forget();
                let discover = || pipeline.discover_observed(frame, &params, &mut laps).map(drop);
                let (found, spent) = timed(|| pool.install(discover));
                found?;
                let asked = before.change();

                let series = format!("{method_name}/{threads}");
                figures.extend(spent.figures(name, &format!("{series}/total")));
                for (stage, spent) in laps.laps {
                    figures.extend(spent.figures(name, &format!("{series}/{stage}")));
                }
                if *threads == 1 {
                    let count = (asked.allocations + asked.reallocations) as f64;
                    let mega = asked.bytes_allocated as f64 / 1e6;
                    for (quantity, value) in [("allocations", count), ("allocated_mb", mega)] {
                        figures.push(Figure {
                            frame: name.clone(),
                            series: format!("{series}/{quantity}"),
                            value,
                        });
                    }
                }
            }
        }
        // Which number of threads comes first takes turns: what comes later finds the caches warm.
        self.pools.reverse();
        let one = &self.one;
        one.install(|| time_normals(name, frame, figures));
        // What every stage that looks at each pixel once must cost at least.
        let (_, spent) = timed(|| frame.depth_m().map(|z| 2.0 * z));
        figures.extend(spent.figures(name, "one pass"));
        if let Some(color) = frame.color() {
            one.install(|| time_graph(name, color, figures))?;
            if let Some(peer) = &mut self.peer {
                let said = peer.segment(color)?.into_iter();
                figures.extend(said.map(|(series, value)| Figure { frame: name.clone(), series, value }));
            }
        }
        Ok(())
    }
}

/// Frames that follow each other on as many threads: enough that the second core is awake, and few, so that a bad moment of the
/// machine meets both numbers of threads.
const TURN: usize = 15;

/// Each method on one frame after the other with nothing in between, on one thread and on two in turns of a few frames.
///
/// # Errors
/// When a method refuses a frame.
pub fn alone(frames: &[Named]) -> Result<Vec<Figure>> {
    let pools = pools()?;
    let mut figures = Vec::new();
    for (method_name, method) in METHODS {
        let params = Params { method, ..Params::default() };
        let mut pipeline = Pipeline::default();
        for turn in frames.chunks(TURN) {
            for (threads, pool) in &pools {
                for Named { name, frame } in turn {
                    pipeline.forget();
                    let discover = || pipeline.discover(frame, &params).map(drop);
                    let (found, spent) = timed(|| pool.install(discover));
                    found?;
                    figures.extend(spent.figures(name, &format!("{method_name}/alone/{threads}")));
                }
            }
        }
    }
    Ok(figures)
}

/// Pools of 1 and of 2 threads.
fn pools() -> Result<Vec<(usize, ThreadPool)>> {
    [1, 2].into_iter().map(|threads| Ok((threads, pool(threads)?))).collect()
}

fn pool(threads: usize) -> Result<ThreadPool> {
    Ok(ThreadPoolBuilder::new().num_threads(threads).build()?)
}

/// The normals of both methods: time, and angle to the table's plane.
fn time_normals(name: &str, frame: &Frame, figures: &mut Vec<Figure>) {
    let params = Params::default();
    let points = frame.points_m();
    let plane = table(&points);
    let mut report = |series: &str, spent: Spent, normals: &Raster<[f32; 3]>| {
        figures.extend(spent.figures(name, series));
        let angle = plane.as_ref().and_then(|plane| median_angle_deg(normals, &points, plane));
        figures.extend(angle.map(|value| Figure {
            frame: name.to_owned(),
            series: format!("{series}/angle_deg"),
            value,
        }));
    };

    let (integral, spent) = timed(|| measure_normals(&points, &params.normals));
    report("integral-image normals", spent, &integral);

    let space = DisparitySpace::new(frame.camera(), &params.sensor);
    let (fitted, spent) = timed(|| {
        let disparity = space.disparity(frame.depth_m());
        let fits = fit_planes(&disparity, space.length_px(params.local_fit.radius_px));
        choose_windows(&disparity, &fits, &space, &params.local_fit)
    });
    report("plane fits", spent, &fitted.normal);
}

/// The graph segmentation of the colour image alone: time, and how many segments.
fn time_graph(name: &str, color: &Raster<[u8; 3]>, figures: &mut Vec<Figure>) -> Result<()> {
    let (frame, params) = (flat_frame(color)?, color_alone());
    let borders = color.map(|_| false);
    let (components, spent) = timed(|| graph_segmentation(&frame, &borders, &params));
    figures.extend(spent.figures(name, "graph"));
    let roots = components.root().iter().enumerate().filter(|&(i, &root)| i == root as usize);
    let segments = roots.count() as f64;
    figures.push(Figure { frame: name.to_owned(), series: "graph/segments".into(), value: segments });
    Ok(())
}
