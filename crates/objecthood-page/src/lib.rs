//! The live page: what objecthood sees of a frame, stage by stage, while its parameters are changed.
//!
//! * [`Session`] is what the page is about: frames that can be read, the parameters to begin with, and words for the page.
//! * [`serve()`] shows it to a browser on this machine, and to nobody else.
//! * [`look()`] runs the method and packs what the page draws. The wire form is documented in docs/PAGE.md.
//!
//! * [`Report`] is a file that shows frames in the same way, without a server; [`Film`] is what it says of a video.
//!
//! The page itself is TypeScript in `web/`. `cargo xtask page` bundles it into `assets/page.js`, which is a part of this crate's source,
//! so that building the crate needs no Node.

mod assets;
mod error;
mod explain;
mod film;
mod findings;
mod follow;
mod guard;
mod label_map;
mod layers;
mod look;
mod maps;
mod pack;
mod pipelines;
mod repair;
mod report;
mod routes;
mod serve;
mod session;
mod settings;
mod votes;

pub use error::{Error, Result};
pub use film::Film;
pub use look::{Look, look};
pub use report::{Page, Report, Shown};
pub use serve::{Address, serve};
pub use session::{FrameList, FrameSource, Session};
pub use settings::Settings;
