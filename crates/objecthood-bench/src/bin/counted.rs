//! One frame by one method on one thread, for valgrind to count the instructions of [`the_counted_part`].
//!
//! usage: `counted scene FILE.pcd` writes the frame, `counted context|paper FILE.pcd` does it

use std::path::Path;

use anyhow::{Context, Result, bail};
use objecthood::{Discovery, Frame, Params, discover};
use objecthood_bench::scenes::write_demo;
use objecthood_bench::times::{METHODS, open};
use rayon::ThreadPoolBuilder;

/// Only what happens in here is counted.
#[inline(never)]
fn the_counted_part(frame: &Frame, params: &Params) -> objecthood::Result<Discovery> {
    discover(frame, params)
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [what, file] = &arguments[..] else { bail!("usage: counted scene|context|paper FILE.pcd") };
    if what == "scene" {
        return write_demo(Path::new(file));
    }
    let (_, method) = METHODS.into_iter().find(|(name, _)| name == what).context("no such method")?;
    let named = open(Path::new(file))?;
    let params = Params { method, ..Params::default() };
    // This thread is the pool, so that valgrind finds all work below the one function.
    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build()?;
    let found = pool.install(|| the_counted_part(&named.frame, &params))?;
    std::hint::black_box(found);
    Ok(())
}
