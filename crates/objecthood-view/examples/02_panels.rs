//! One frame in, a picture of every stage out.
//!
//! `cargo run --release -p objecthood-view --example 02_panels -- boxes.panels.png`

#[path = "../../objecthood/examples/world/mod.rs"]
mod world;

use objecthood::{Params, discover_observed};
use objecthood_view::{Recording, panels, png};
use world::{Solid, snapshot};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let out = std::env::args_os().nth(1).ok_or("name the picture to write: 02_panels PICTURE.png")?;
    let [red, blue, green, white] = [[180, 40, 30], [30, 70, 150], [60, 140, 60], [200, 200, 190]];
    let frame = snapshot(&[
        Solid { base_m: [-0.18, 0.02, 0.0], size_m: [0.24, 0.18, 0.1], yaw_deg: 20.0, color: white },
        Solid { base_m: [-0.18, 0.05, 0.1], size_m: [0.12, 0.1, 0.1], yaw_deg: 45.0, color: red },
        Solid { base_m: [0.19, 0.06, 0.0], size_m: [0.14, 0.14, 0.2], yaw_deg: -30.0, color: blue },
        Solid { base_m: [0.12, -0.2, 0.0], size_m: [0.16, 0.08, 0.06], yaw_deg: 10.0, color: green },
    ]);

    // The recording observes the stages; the panels draw what it saw.
    let mut recording = Recording::default();
    let found = discover_observed(&frame, &Params::default(), &mut recording)?;

    std::fs::write(out, png(&panels(&frame, &recording, &found))?)?;
    Ok(())
}
