//! Pictures of what objecthood sees in a frame.
//!
//! - [`overlay()`] draws the outlines and numbers of the objects on the colour image.
//! - [`Recording`] watches [`objecthood::discover_observed`] and keeps what a picture needs of every stage; [`panels()`] draws the
//!   stages side by side.
//! - [`comparison()`] draws several label images of one frame.
//! - [`explanation()`] draws why a pixel is what it is.
//! - [`png`] makes a file of a picture.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use objecthood::{Camera, Frame, Params, Raster, discover_observed};
//! use objecthood_view::{Recording, panels, png};
//!
//! let depth_m = Raster::filled(64, 48, 1.0)?;
//! let frame = Frame::new(depth_m, None, Camera::new(52.5, 52.5, 31.5, 23.5)?)?;
//! let mut recording = Recording::default();
//! let discovery = discover_observed(&frame, &Params::default(), &mut recording)?;
//!
//! let picture = panels(&frame, &recording, &discovery);
//! assert!(png(&picture)?.starts_with(b"\x89PNG"));
//! # Ok(())
//! # }
//! ```

mod comparison;
mod distance;
mod drawing;
mod explanation;
mod grid;
mod labels;
mod objects;
mod overlay;
mod palette;
mod panels;
pub mod plot;
mod recording;
mod region_colors;
mod support;
#[cfg(test)]
mod testing;
mod text;
mod tiles;
mod timeline;
mod view;
mod vision;

pub use comparison::comparison;
pub use explanation::explanation;
pub use overlay::overlay;
pub use palette::object_color;
pub use panels::{panels, png};
pub use recording::Recording;
pub use region_colors::stage_colors;
pub use timeline::{Mark, filmed};
