//! `objecthood explain`: why a pixel or an object is what it is.

use anyhow::Result;
use indicatif::ProgressBar;
use objecthood::explain::{Explainer, Pixels, RepairSearch};
use objecthood::{Error, ObjectId, Params, Pipeline};
use objecthood_io::explanation::{ExplanationFile, RepairFile, in_words, repairs_in_words};
use objecthood_io::scope::Scope;
use objecthood_io::{Capture, output};

use crate::args::{CameraArg, ExplainArgs};
use crate::failure::{Outcome, usage};
use crate::inputs::{Input, Inputs};
use crate::outputs::{make_folder, refuse_file, with_suffix};
use crate::{config, crew, inputs, terminal};

/// What to do; nothing is in doubt any more.
struct Plan<'a> {
    args: &'a ExplainArgs,
    input: Input,
    scope: Scope,
    params: Params,
}

/// Explains one pixel of one frame.
///
/// # Errors
/// Of usage; when the frame cannot be read or looked at; when stdout or the picture cannot be written.
pub(crate) fn run(args: &ExplainArgs) -> Result<Outcome> {
    let plan = Plan::new(args)?;
    let name = plan.input.path.display().to_string();
    let spinner = terminal::spinner(args.settings.verbose);
    spinner.set_message("reading the frame");
    let capture = args.frames.read(&plan.input, &plan.scope)?;
    let explained = crew::pool(args.settings.threads())?.install(|| plan.explain(&name, &capture, &spinner));
    spinner.finish_and_clear();
    terminal::print(&explained?)?;
    Ok(Outcome::AllDone)
}

impl<'a> Plan<'a> {
    fn new(args: &'a ExplainArgs) -> Result<Self> {
        let params = config::params(&args.settings.parameters, args.method)?;
        let camera = args.frames.camera.as_ref().map(CameraArg::read).transpose()?;
        args.frames.scale_note(camera.as_ref()).iter().for_each(|note| terminal::note(note));
        let Inputs { mut frames, unreadable, .. } = inputs::collect(&args.frames, false, camera.as_ref())?;
        let scope = args.frames.scope.read(args.frames.images.max_pixels)?;
        if let Some(out) = &args.out {
            refuse_file("--out", out)?;
        }
        if let Some(error) = unreadable.into_iter().next() {
            return Err(error);
        }
        match (frames.len(), frames.pop()) {
            (1, Some(input)) => Ok(Self { args, input, scope, params }),
            (count, _) => Err(usage(format!(
                "{count} frames are named, and explain looks at one: choose it, as by --frames 3..4"
            ))),
        }
    }

    /// Writes the picture and returns the text to print.
    fn explain(&self, name: &str, capture: &Capture, spinner: &ProgressBar) -> Result<String> {
        spinner.set_message("finding the objects");
        let explainer =
            Explainer::new(&Pipeline::default(), &capture.frame, &self.params).map_err(said_of_usage)?;
        let pixel = self.pixel(&explainer)?;
        if self.args.repair {
            return self.repair(name, &explainer, pixel, spinner);
        }
        spinner.set_message("trying which parameters would change the answer");
        let explanation = explainer.explain(pixel).map_err(said_of_usage)?;
        let mut text = if self.args.printed.json {
            ExplanationFile::new(name, &self.params, &explanation).to_json()?
        } else {
            in_words(name, &self.params, &explanation)
        };
        if let Some(folder) = &self.args.out {
            make_folder(folder)?;
            let labels = &explainer.discovery().labels;
            let picture =
                objecthood_view::explanation(&capture.frame, explainer.facets(), labels, &explanation);
            let path = with_suffix(&folder.join(&self.input.name), ".explain.png");
            output::write_together(&[(path.clone(), objecthood_view::png(&picture)?)])?;
            if !self.args.printed.json {
                text.push_str(&format!("\n{}\n", path.display()));
            }
        }
        Ok(text)
    }

    /// Tries every parameter and returns the text to print.
    fn repair(
        &self,
        name: &str,
        explainer: &Explainer,
        pixel: [usize; 2],
        spinner: &ProgressBar,
    ) -> Result<String> {
        let pixels = Pixels { pixel, with: self.args.with };
        let mut search = RepairSearch::new(explainer, pixels).map_err(said_of_usage)?;
        while let Some(next) = search.left.first() {
            spinner.set_message(format!("trying {next}, {} more parameters", search.left.len() - 1));
            search.step(explainer);
        }
        Ok(if self.args.printed.json {
            RepairFile::new(name, &self.params, &search).to_json()?
        } else {
            repairs_in_words(name, &search)
        })
    }

    /// The pixel to explain.
    fn pixel(&self, explainer: &Explainer) -> Result<[usize; 2]> {
        let Some(id) = self.args.object else { return Ok(self.args.at.unwrap_or_default()) };
        explainer.pixel_of(ObjectId(id)).ok_or_else(|| {
            let count = explainer.discovery().objects.len();
            usage(match count {
                0 => "no object was found in this frame: ask for a pixel by --at".to_owned(),
                _ => format!("there is no object {id}: the objects of this frame are 1 to {count}"),
            })
        })
    }
}

/// A question that cannot be answered is a mistake on the command line; anything else failed.
fn said_of_usage(error: Error) -> anyhow::Error {
    match error {
        Error::OutsideImage { .. } => usage(format!("--at or --with: {error}")),
        Error::OnlyContext { .. } => usage(format!("{error}: give --method context")),
        _ => error.into(),
    }
}
