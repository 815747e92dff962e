//! What is compared on a data set: a method with its parameters set in several ways.

mod ablation;
mod ladder;
mod sensitivity;

use objecthood::Params;

pub use ablation::{ablated, ablation};
pub use ladder::ladder;
pub use sensitivity::{changes_choice, sensitivity};

/// Parameters under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// What tells it apart from the others.
    pub name: String,
    /// The parameters.
    pub params: Params,
}
