//! One frame by one method on one thread, for valgrind to count the instructions of [`the_counted_part`].
//!
//! usage: `counted context|paper FILE`; `measure demo FILE` of objecthood-bench writes the file

use anyhow::{Context, Result, bail};
use objecthood::{Discovery, Frame, Method, Params, discover};
use rayon::ThreadPoolBuilder;

/// Only what happens in here is counted.
#[inline(never)]
fn the_counted_part(frame: &Frame, params: &Params) -> objecthood::Result<Discovery> {
    discover(frame, params)
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [method, file] = &arguments[..] else { bail!("usage: counted context|paper FILE") };
    let method = match method.as_str() {
        "context" => Method::Context,
        "paper" => Method::Paper,
        _ => bail!("{method}: no such method"),
    };
    let bytes = std::fs::read(file).with_context(|| file.clone())?;
    let frame = objecthood_counted::from_bytes(&bytes).with_context(|| file.clone())?;
    let params = Params { method, ..Params::default() };
    // This thread is the pool, so that valgrind finds all work below the one function.
    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build()?;
    let found = pool.install(|| the_counted_part(&frame, &params))?;
    std::hint::black_box(found);
    Ok(())
}
