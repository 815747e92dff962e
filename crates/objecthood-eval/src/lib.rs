//! How good is what was discovered? Data sets with truth, matching and metrics for `objecthood`.
//!
//! The way of one evaluation:
//!
//! 1. [`dataset`]: a data set finds its [scenes], reads each as a frame with a [`Truth`] and declares
//!    the [`Roles`] of its labels.
//! 2. [`score()`]: a label image against the truth. [`metrics`] pairs objects with hypotheses and measures overlap
//!    and boundary; [`verdict`] judges every object strictly.
//! 3. [`stages`]: how superpixels, facets and shapes fit the truth, watched by an observer while a method runs.
//! 4. [`evaluate()`] does that over many scenes in parallel; [`report`] sums up and prints.
//! 5. [`settings`] are what is compared, and [`composer`] makes harder scenes to compare on.
//!
//! The figures are those of docs/EVALUATION.md, Definitions, and agree with the project's independent scorer, `tools/score.py`, to the
//! last printed digit; tests hold them against it.
//!
//! ```no_run
//! use objecthood_eval::{Prediction, StageObserver, evaluate, scenes};
//!
//! let params = objecthood::Params::default();
//! let scenes = scenes("mosd".as_ref(), &"learn".parse()?)?;
//! let report = evaluate(&scenes, None, |scene, _| {
//!     let mut observer = StageObserver::new(&scene.truth);
//!     let discovery = objecthood::discover_observed(&scene.frame, &params, &mut observer)?;
//!     let stages = Some(observer.into_stages()?);
//!     Ok::<_, Box<dyn std::error::Error + Send + Sync>>(Prediction {
//!         labels: discovery.labels,
//!         objects: Some(discovery.objects),
//!         stages,
//!     })
//! })?;
//! println!("{}", report.total);
//! # Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
//! ```

mod assignment;
mod bop;
mod boundary;
pub mod composer;
mod contingency;
pub mod dataset;
pub mod error;
pub mod evaluate;
pub mod metrics;
pub mod mosd;
mod numpy;
mod ocid;
mod osd;
mod painted;
#[cfg(test)]
mod python;
pub mod ranking;
pub mod report;
pub mod score;
pub mod settings;
pub mod stages;
pub mod support;
pub mod truth;
pub mod verdict;
pub mod video;

pub use composer::Composer;
pub use dataset::{Scene, SceneRef, Split, scenes};
pub use error::{Error, Result};
pub use evaluate::{LabelFolder, Prediction, evaluate, evaluate_composites, evaluate_settings};
pub use metrics::{ImageMetrics, Prf};
pub use ranking::{Ranked, Ranking, ranked};
pub use report::{
    FamiliesTable, FamilyFigures, FoldersTable, LossesList, Report, SceneReport, SettingsTable, StagesTable,
    Totals, VerdictsTable,
};
pub use score::{ImageScore, numbered_as_truth, object_map, score};
pub use settings::{Setting, ablation, ladder, sensitivity};
pub use stages::{StageMetrics, StageObserver, Stages};
pub use truth::{Roles, Truth};
pub use verdict::{ObjectScore, Verdict, VerdictCounts};
