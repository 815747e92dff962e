//! Why a pixel is what it is: the explanation as text, and as a file of JSON.

mod repairs;
mod text;
mod verdict;
mod words;

use objecthood::Params;
use objecthood::explain::Explanation;
use serde::Serialize;

use crate::error::Result;
use crate::json;
use crate::scene::fingerprint;

pub use repairs::{RepairFile, repairs_in_words, side_effects, sought};
pub use text::in_words;

/// Version of the form that is written.
pub const VERSION: u32 = 1;

/// What an answer is of: the program, the frame and the parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Origin<'a> {
    /// Version of objecthood that wrote it.
    pub objecthood_version: &'static str,
    /// Path of the input, as it was given.
    pub input: &'a str,
    /// SHA-256 of all parameters, in hexadecimal, as in the scene file.
    pub parameters_fingerprint: String,
}

impl<'a> Origin<'a> {
    fn new(input: &'a str, params: &Params) -> Self {
        let objecthood_version = env!("CARGO_PKG_VERSION");
        Self { objecthood_version, input, parameters_fingerprint: fingerprint(params) }
    }
}

/// An [`Explanation`] with what it is of. What does not apply is left out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExplanationFile<'a> {
    /// Version of this form: 1.
    pub explanation_version: u32,
    /// What it is of.
    #[serde(flatten)]
    pub origin: Origin<'a>,
    /// The explanation.
    #[serde(flatten)]
    pub explanation: &'a Explanation,
}

impl<'a> ExplanationFile<'a> {
    /// Of a frame, named as the user would.
    pub fn new(input: &'a str, params: &Params, explanation: &'a Explanation) -> Self {
        Self { explanation_version: VERSION, origin: Origin::new(input, params), explanation }
    }

    /// As JSON that ends with a line end.
    ///
    /// # Errors
    /// [`Error::NotFinite`](crate::Error::NotFinite) names the place of a value that JSON cannot hold.
    pub fn to_json(&self) -> Result<String> {
        json::pretty(self)
    }
}
