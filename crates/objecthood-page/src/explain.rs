//! Why a pixel is what it is: the same answer, in the same words, as that of `objecthood explain`.

use objecthood::explain::{Explainer, Explanation};
use objecthood::{ObjectId, Params, Pipeline};
use objecthood_io::Capture;
use objecthood_io::explanation::{ExplanationFile, in_words};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::error::Result;
use crate::settings::Settings;

/// What to explain: a pixel, or an object.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Question {
    /// The number of the frame.
    pub(crate) frame: usize,
    /// The parameters.
    pub(crate) settings: Settings,
    /// Column and row; counts where no object is named.
    pub(crate) pixel: [usize; 2],
    /// The number of an object.
    pub(crate) object: Option<u16>,
}

/// A question that can be answered twice: at once, and after a search for what would change the answer.
pub(crate) struct Asked {
    explainer: Explainer,
    params: Params,
    name: String,
    pixel: [usize; 2],
}

impl Asked {
    /// Of the stages only those run that the pipeline has not kept.
    ///
    /// # Errors
    /// What the method fails with; [`objecthood::Error::OnlyContext`].
    pub(crate) fn new(
        pipeline: &Pipeline,
        name: &str,
        capture: &Capture,
        question: &Question,
    ) -> Result<Self> {
        let params = question.settings.params()?;
        let explainer = Explainer::new(pipeline, &capture.frame, &params)?;
        let of_object = question.object.and_then(|id| explainer.pixel_of(ObjectId(id)));
        let pixel = of_object.unwrap_or(question.pixel);
        Ok(Self { explainer, params, name: name.to_owned(), pixel })
    }

    /// The answer without what would change it.
    ///
    /// # Errors
    /// [`objecthood::Error::OutsideImage`].
    pub(crate) fn at_once(&self) -> Result<Value> {
        self.said(&self.explainer.describe(self.pixel)?)
    }

    /// The whole answer.
    ///
    /// # Errors
    /// [`objecthood::Error::OutsideImage`].
    pub(crate) fn in_full(&self) -> Result<Value> {
        self.said(&self.explainer.explain(self.pixel)?)
    }

    fn said(&self, explanation: &Explanation) -> Result<Value> {
        let file = ExplanationFile::new(&self.name, &self.params, explanation);
        Ok(json!({ "text": in_words(&self.name, &self.params, explanation), "explanation": file }))
    }
}
