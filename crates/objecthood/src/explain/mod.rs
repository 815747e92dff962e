//! Explanations: the object of a pixel, the borders and rules that decided it, and the parameter values that would decide otherwise.
//!
//! An [`Explainer`] runs the method `context` on a frame, as [`discover`](crate::discover) does, and keeps the outputs of the stages.
//! [`Explainer::explain`] returns an [`Explanation`] of one pixel, which is plain data.
//!
//! The algorithms do not depend on this module. Rules are explained by the [`Check`]s with which they
//! decided. The influence of parameters is found by deciding again with other values: see [`Flip`]. A
//! [`RepairSearch`] tries all parameters, whichever of them decided.

mod belonging;
mod borders;
mod explanation;
mod flip;
mod guess;
mod others;
mod repair;
mod run;
mod steps;
mod subject;
mod sweep;
mod thing;
mod trials;

pub use belonging::{Belonging, Pixels};
pub use explanation::{
    BorderReport, Decision, Explanation, FacetReport, Flip, ObjectReport, Outcome, Part, Question, Reason,
};
pub use others::Others;
pub use repair::{Repair, RepairSearch, Value};

use std::collections::BTreeSet;
use std::sync::OnceLock;

use crate::check::Check;
use crate::discovery::Discovery;
use crate::discovery::ids::ObjectId;
use crate::discovery::parts::ObjectnessParts;
use crate::error::{Error, Result};
use crate::explain::flip::Search;
use crate::explain::run::Run;
use crate::explain::subject::Subject;
use crate::frame::Frame;
use crate::objectness::hypotheses::Hypothesis;
use crate::params::{Method, Params};
use crate::pipeline::Pipeline;
use crate::regions::{SegmentId, Segments};
use crate::surface::disparity::position;

/// A frame with the outputs of the method, ready for questions.
pub struct Explainer {
    subject: Subject,
}

impl Explainer {
    /// Runs the method on a clone of `pipeline`. No stage runs again if this frame and these parameters were the pipeline's last.
    ///
    /// # Errors
    /// As [`discover`](crate::discover); [`Error::OnlyContext`] with another method, before any stage runs.
    pub fn new(pipeline: &Pipeline, frame: &Frame, params: &Params) -> Result<Self> {
        let refused = Error::OnlyContext { method: params.method.to_string() };
        if params.method != Method::Context {
            return Err(refused);
        }
        let mut pipeline = pipeline.clone();
        pipeline.discover(frame, params)?;
        let outputs = pipeline
            .context_outputs()
            .and_then(|outputs| Some((outputs.surfaces.clone()?, Run::new(outputs)?)));
        let Some((surfaces, run)) = outputs else { return Err(refused) };
        let (frame, params) = (frame.clone(), params.clone());
        let sweep = OnceLock::new();
        Ok(Self { subject: Subject { pipeline, frame, params, surfaces, run, sweep } })
    }

    /// The result for the frame.
    pub fn discovery(&self) -> &Discovery {
        &self.subject.run.discovery
    }

    /// The facets after the gaps between them are filled. The facets of the structure come first.
    pub fn facets(&self) -> &Segments {
        &self.subject.run.filled.segments
    }

    /// A pixel (column, row) that represents an object: the pixel of its largest facet nearest to that facet's middle. Facets of the
    /// structure are used only if the object has no other.
    pub fn pixel_of(&self, id: ObjectId) -> Option<[usize; 2]> {
        let mut pixels: Vec<Vec<usize>> = vec![Vec::new(); self.facets().count()];
        let labels = &self.discovery().labels;
        self.facets().members().filter(|&(i, _)| labels[i] == id.0).for_each(|(i, f)| pixels[f].push(i));
        // The structure in a plate is its bottom, and not the part that the question is about.
        let own = (0..pixels.len()).rev().filter(|&facet| !pixels[facet].is_empty());
        let largest = &pixels
            [own.max_by_key(|&facet| (facet >= self.subject.run.filled.structure, pixels[facet].len()))?];
        let at = |i: usize| position(i, labels.width());
        let middle = [0, 1].map(|k| largest.iter().map(|&i| at(i)[k]).sum::<f64>() / largest.len() as f64);
        let off = |i: usize| [0, 1].map(|k| (at(i)[k] - middle[k]).powi(2)).iter().sum::<f64>();
        let nearest = largest.iter().copied().min_by(|&i, &j| off(i).total_cmp(&off(j)))?;
        Some([nearest % labels.width(), nearest / labels.width()])
    }

    /// Explains a pixel (column, row): its outcome, the decisions behind it, and for each decision the parameter value that would turn
    /// it. O(pixels), plus trials with single parameters changed that cost up to 16 runs of the method; decisions beyond this budget
    /// have [`Flip::NotSought`].
    ///
    /// # Errors
    /// [`Error::OutsideImage`].
    pub fn explain(&self, pixel: [usize; 2]) -> Result<Explanation> {
        let mut explanation = self.describe(pixel)?;
        let mut search = self.search();
        explanation.decisions_mut().for_each(|decision| decision.flip = search.flip(decision));
        Ok(explanation)
    }

    /// The parameter value that would turn one decision. See [`Self::explain`].
    pub fn flip(&self, decision: &Decision) -> Flip {
        self.search().flip(decision)
    }

    /// The answer to a question about facets of this frame. Facets keep their numbers as long as no parameter of the first two stages
    /// changes.
    pub fn answer(&self, question: Question) -> bool {
        self.subject.run.answer(question)
    }

    fn search(&self) -> Search<'_> {
        Search::new(&self.subject)
    }

    /// As [`Self::explain`], but without a search for flips: every flip is [`Flip::NotSought`]. O(pixels).
    ///
    /// # Errors
    /// [`Error::OutsideImage`].
    pub fn describe(&self, [u, v]: [usize; 2]) -> Result<Explanation> {
        let (width, height) = self.subject.frame.size();
        if u >= width || v >= height {
            return Err(Error::OutsideImage { pixel: [u, v], size: (width, height) });
        }
        let i = v * width + u;
        let depth_m = self.subject.frame.is_valid(i).then(|| self.subject.frame.depth_m()[i]);
        let mut explanation = Explanation {
            pixel: [u, v],
            depth_m,
            outcome: if depth_m.is_some() { Outcome::NoFacet } else { Outcome::NoDepth },
            facet: None,
            kept: None,
            borders: Vec::new(),
            way: Vec::new(),
            near_misses: Vec::new(),
            object: None,
        };
        // A small hole that was bridged has a facet, but no point: it belongs to nothing.
        let Some(facet) = depth_m.and_then(|_| self.facets().at(i)) else { return Ok(explanation) };

        let report = self.facet(facet, i);
        explanation.facet = Some(report);
        explanation.object = self.subject.run.hypothesis_at(i).map(|hypothesis| self.object(hypothesis));
        explanation.outcome = self.outcome(facet, i);
        match self.subject.run.free(facet) {
            Some(_) => {
                explanation.kept = Some(self.kept(facet));
                explanation.way = self.way(facet);
                explanation.near_misses = self.near_misses(facet);
            }
            None => {
                explanation.kept = Some(self.of_structure(facet, [u, v], report.residual_quanta));
                explanation.way = self.bottom(i);
            }
        }
        explanation.borders = self.borders(facet);
        Ok(explanation)
    }

    fn facet(&self, facet: SegmentId, pixel: usize) -> FacetReport {
        let width = self.subject.surfaces.disparity.width();
        let model = &self.subject.run.filled.models[facet.index()];
        let residual =
            |i: usize| f64::from(self.subject.surfaces.disparity[i]) - model.value(position(i, width));
        let own = self.facets().members().filter(|&(_, f)| f == facet.index());
        let (mut squared, mut size_px) = (0.0, 0);
        for (i, _) in own {
            squared += residual(i).powi(2);
            size_px += 1;
        }
        FacetReport {
            facet: facet.0,
            size_px,
            residual_quanta: residual(pixel),
            mean_residual_quanta: (squared / size_px as f64).sqrt(),
            structure_plane: self.plane(facet),
        }
    }

    /// The number of a structure plane in the label image of the structure, if the facet is one.
    fn plane(&self, facet: SegmentId) -> Option<u32> {
        (facet.index() < self.subject.run.filled.structure).then_some(facet.0 + 1)
    }

    fn outcome(&self, facet: SegmentId, pixel: usize) -> Outcome {
        let label = self.discovery().labels[pixel];
        let in_structure = self.discovery().structure[pixel];
        match (label, self.plane(facet)) {
            (0, Some(plane)) => Outcome::Structure { plane },
            (0, None) if self.subject.run.cluster(facet).is_none() => {
                Outcome::Background { plane: in_structure }
            }
            (0, None) if self.subject.run.hypothesis_at(pixel).is_some() => Outcome::Unlikely,
            (0, None) => Outcome::TooSmall,
            (object, _) => Outcome::Object { object },
        }
    }

    fn object(&self, hypothesis: &Hypothesis) -> ObjectReport {
        let own = hypothesis.pixels.iter().filter_map(|&i| self.facets().at(i));
        let facets: BTreeSet<u32> = own.map(|facet| facet.0).collect();
        let label = self.discovery().labels[hypothesis.pixels[0]];
        ObjectReport {
            object: (label > 0).then_some(label),
            objectness: hypothesis.objectness,
            parts: parts(&hypothesis.parts),
            size_px: hypothesis.pixels.len(),
            facets: facets.into_iter().collect(),
        }
    }

    /// A decision without its flip.
    fn decision(&self, question: Question, reason: Reason, checks: Vec<Check>) -> Decision {
        Decision { question, yes: self.subject.run.answer(question), reason, checks, flip: Flip::NotSought }
    }
}

/// The named parts of an objectness.
fn parts(parts: &ObjectnessParts) -> Vec<Part> {
    let &ObjectnessParts { size, support, footing, compactness, separation, visibility } = parts;
    let named = [
        ("size", size),
        ("support", support),
        ("footing", footing),
        ("compactness", compactness),
        ("separation", separation),
        ("visibility", visibility),
    ];
    named.map(|(name, value)| Part { name, value: f64::from(value) }).into()
}
