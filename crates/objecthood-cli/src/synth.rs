//! `objecthood synth`: numbers -> synthetic scenes and videos in files that `segment` and `eval` take.

mod videos;

use std::path::Path;

use anyhow::{Context, Result};
use objecthood_io::output;
use objecthood_scene::Family;

use crate::args::SynthArgs;
use crate::failure::Outcome;
use crate::outputs::{make_folder, make_folders_of, refuse_file};
use crate::shell::{program, word};
use crate::synthetic::{Recipe, camera_file, camera_path, color_path, depth_path, recipes};
use crate::words::counted;
use crate::{crew, terminal};

/// Makes the scenes or videos named on the command line.
///
/// # Errors
/// Of usage; when the folder or the camera's file cannot be written; when stdout cannot be written. A scene that fails
/// is reported, which is no error.
pub(crate) fn run(args: &SynthArgs) -> Result<Outcome> {
    refuse_file("--out", &args.out)?;
    match &args.video {
        Some(clips) => videos::run(args, &clips.0),
        None => scenes(args),
    }
}

/// Makes scenes.
fn scenes(args: &SynthArgs) -> Result<Outcome> {
    let first = Recipe {
        holes: args.holes,
        size_px: args.size,
        ..Recipe::new(args.family.unwrap_or(Family::Single), args.seed.into(), args.sensor)
    };
    let recipes = recipes(args.family, first, args.scenes.unwrap_or(1));
    make_folder(&args.out)?;
    // One camera took all pictures. Its file comes first, so that every finished scene can be used.
    if let Some(first) = recipes.first() {
        let (path, bytes) = camera_file(&first.world()?, &args.out)?;
        output::write_atomically(&path, &bytes)?;
    }

    let bar = terminal::progress_bar(recipes.len(), false);
    let work = |(): &mut (), recipe: &Recipe| write(recipe, &args.out);
    let reported = crew::report_in_order(&recipes, args.threads.count(), &bar, work, |_, text| {
        text.unwrap_or_default()
    })?;
    let outcome = reported.sum_up("scenes", 0)?;
    if outcome == Outcome::AllDone {
        terminal::print(&next_steps(&args.out))?;
    }
    Ok(outcome)
}

/// Makes one scene and writes all of its files or none. Returns a line that describes it.
fn write(recipe: &Recipe, folder: &Path) -> Result<String> {
    let name = recipe.name();
    let scene = recipe.make().with_context(|| name.clone())?;
    let objects = scene.world.objects().count();
    let files = scene.into_files(folder).with_context(|| name.clone())?;
    make_folders_of(&files)?;
    output::write_together(&files).with_context(|| name.clone())?;
    let names = folder.join(format!("{name}-*"));
    Ok(format!("{name}: {} -> {}\n", counted(objects, "object"), names.display()))
}

/// What to do with the scenes, as commands.
fn next_steps(folder: &Path) -> String {
    let (color, depth) = (word(&color_path(folder, "*")), word(&depth_path(folder, "*")));
    let (camera, found) = (word(&camera_path(folder)), word(&folder.join("found")));
    let (program, folder) = (program(), word(folder));
    format!(
        "\nnext:\n  \
         {program} segment --color {color} --depth {depth} --camera {camera} --out {found} --write labels,json,panels\n  \
         {program} eval {folder} --labels {found}\n  \
         {program} eval {folder}\n"
    )
}
