//! Synthetic RGB-D scenes with exact truth, and what real depth cameras make of them.
//!
//! ```
//! use objecthood_scene::{Family, Sensor, generate, render};
//!
//! let world = generate(Family::Single, 7);
//! let seen = render(&world, Sensor::Kinect)?;
//! let found = objecthood::discover(&seen.frame, &objecthood::Params::default())?;
//! let truly_there = world.objects().filter(|&k| seen.truth.instance.as_slice().contains(&k)).count();
//! println!("{} of {truly_there} objects found", found.objects.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`World`] is a room with a table, things in exact contact ([`Contact`]), light and a camera. [`generate`] draws one of a
//! [`Family`] from a seed; [`render`] takes its picture with a [`Sensor`]; [`export`] gives picture and truth their
//! file forms.
//!
//! The same seed gives the same bytes on every machine and any number of threads: random numbers are our own, those of
//! pixels by their address, and transcendental functions come from `libm`.

mod color;
mod contact;
mod error;
pub mod export;
mod family;
mod holes;
mod light;
mod noise;
mod place;
mod pose;
pub mod random;
mod ray;
mod render;
mod sensor;
mod shape;
mod solid;
mod texture;
mod thing;
mod truth;
pub mod video;
mod view;
mod world;

pub use contact::{Contact, ContactKind};
pub use error::{Error, Result};
pub use family::{Family, crowd, generate};
pub use holes::Holes;
pub use pose::Pose;
pub use render::{Exposure, Rendered, render};
pub use sensor::Sensor;
pub use solid::{Role, Solid};
pub use truth::Truth;
pub use world::{Viewpoint, World};
