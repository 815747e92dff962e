//! `objecthood demo --video`: makes a video, follows its objects, and compares them with the truth, by the commands that do so.

use std::ffi::OsString;
use std::path::Path;

use anyhow::Result;
use objecthood_scene::video::Clip;

use crate::args::{Cli, DemoArgs};
use crate::failure::Outcome;
use crate::shell::{program, word};
use crate::terminal;

/// Runs the commands one after the other and shows each before what it says.
///
/// # Errors
/// Those of the commands.
pub(super) fn run(args: &DemoArgs, clip: Clip) -> Result<Outcome> {
    let made = args.out.join(format!("{clip}{}", args.seed));
    let found = args.out.join(format!("{clip}{}-tracks", args.seed));
    let (kind, seed) = (clip.to_string(), args.seed.to_string());
    let [out, clip, tracks] = [&args.out, &made, &found].map(|path| path.as_os_str());
    let option = OsString::from;
    let commands: [Vec<OsString>; 3] = [
        vec![
            "synth".into(),
            "--video".into(),
            kind.into(),
            "--seed".into(),
            seed.into(),
            "--out".into(),
            out.into(),
        ],
        vec![
            option("track"),
            clip.into(),
            "--out".into(),
            tracks.into(),
            "--write".into(),
            "pictures".into(),
            "--summary".into(),
        ],
        vec![option("eval"), "--tracks".into(), tracks.into(), "--truth".into(), clip.into()],
    ];
    for words in commands {
        let shown: Vec<String> = words.iter().map(|text| word(Path::new(text))).collect();
        terminal::print(&format!("$ {} {}\n", program(), shown.join(" ")))?;
        let cli = Cli::of(std::iter::once(option("objecthood")).chain(words))?;
        let outcome = crate::run(&cli.command)?;
        if outcome != Outcome::AllDone {
            return Ok(outcome);
        }
    }
    terminal::print(&format!("look at: {}\n", word(&found.join("pictures"))))?;
    Ok(Outcome::AllDone)
}
