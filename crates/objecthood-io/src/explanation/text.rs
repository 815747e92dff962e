//! An explanation as text.

use std::fmt::Write;

use objecthood::Params;
use objecthood::explain::{BorderReport, Decision, Explanation, ObjectReport, Question};

use super::verdict::verdict;
use super::words;

/// Borders that are printed; a table has many more.
const BORDERS: usize = 16;

/// All of it, for a terminal: `input` is what the user calls the frame, `params` what it was explained with.
pub fn in_words(input: &str, params: &Params, explanation: &Explanation) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut text, input, params, explanation);
    text
}

fn write(text: &mut String, input: &str, params: &Params, explanation: &Explanation) -> std::fmt::Result {
    writeln!(text, "{}", verdict(explanation, params))?;
    let [u, v] = explanation.pixel;
    write!(text, "{input}: pixel {u},{v}")?;
    if let Some(depth_m) = explanation.depth_m {
        write!(text, " at {depth_m:.3} m")?;
    }
    writeln!(text)?;
    if let Some(object) = &explanation.object {
        writeln!(text, "{}", of_object(object))?;
    }
    if let Some(facet) = &explanation.facet {
        let side = if facet.residual_quanta < 0.0 { "behind" } else { "before" };
        writeln!(
            text,
            "facet {}: {} px, {:.2} quanta off its surface (root mean square); the pixel {:.2} quanta {side} it",
            facet.facet,
            facet.size_px,
            facet.mean_residual_quanta,
            facet.residual_quanta.abs()
        )?;
    }
    if let Some(kept) = &explanation.kept {
        writeln!(text, "\nIs it an object?")?;
        decision(text, params, kept)?;
    }
    section(text, params, "Rules that joined parts to it", &explanation.way)?;
    section(text, params, "Rules that nearly joined parts to it", &explanation.near_misses)?;
    if !explanation.borders.is_empty() {
        borders(text, explanation)?;
    }
    Ok(())
}

fn of_object(object: &ObjectReport) -> String {
    let facets: Vec<String> = object.facets.iter().map(u32::to_string).collect();
    let parts: Vec<String> =
        object.parts.iter().map(|part| format!("{} {:.2}", part.name, part.value)).collect();
    format!(
        "objectness {:.2} ({}); {} px; facets {}",
        object.objectness,
        parts.join(", "),
        object.size_px,
        facets.join(" ")
    )
}

fn section(text: &mut String, params: &Params, title: &str, decisions: &[Decision]) -> std::fmt::Result {
    if decisions.is_empty() {
        return Ok(());
    }
    writeln!(text, "\n{title}")?;
    decisions.iter().try_for_each(|found| decision(text, params, found))
}

fn decision(text: &mut String, params: &Params, decision: &Decision) -> std::fmt::Result {
    let Decision { question, yes, reason, checks, flip } = decision;
    let answer = if *yes { "yes" } else { "no" };
    match question {
        Question::OneThing { facets: [a, b] } => {
            let verb = if *yes { "are one" } else { "are two" };
            writeln!(text, "  facets {a} and {b} {verb}: {}", words::reason(*reason))?;
        }
        Question::Kept { .. } | Question::OfObject { .. } => {
            writeln!(text, "  {answer}: {}", words::reason(*reason))?;
        }
        Question::Bottom { facet, patch: [u, v] } => {
            let verb = if *yes { "belongs" } else { "does not belong" };
            writeln!(
                text,
                "  the patch of the table that begins at {u},{v} {verb} to facet {facet}: {}",
                words::reason(*reason)
            )?;
        }
    }
    checks.iter().try_for_each(|check| writeln!(text, "    {}", words::formula(check, params)))?;
    writeln!(text, "    {}", words::flip(flip))
}

/// With one decimal place and a sign; nothing is +0.0, from whichever side it was rounded.
fn signed(value: f64) -> String {
    let tenths = (10.0 * value).round() / 10.0;
    format!("{:+.1}", tenths + 0.0)
}

fn borders(text: &mut String, explanation: &Explanation) -> std::fmt::Result {
    let own = explanation.facet.map_or(0, |facet| facet.facet);
    writeln!(text, "\nBorders of facet {own}, the longest first")?;
    writeln!(text, "  with         angle     gap before it     fold     step     vote")?;
    writeln!(text, "  {:<11}  [deg]  [quanta]     [mm]     [mm]     [mm]     [mm]", "")?;
    for border in explanation.borders.iter().take(BORDERS) {
        let BorderReport { mean_angle_deg, gap_quanta, gap_mm, folded_mm, stepped_mm, vote_mm, .. } = border;
        let with = match border.structure_plane {
            Some(plane) => format!("plane {plane}"),
            None => format!("facet {}", border.facet),
        };
        let optional = |value: &Option<f64>| value.map_or("-".to_owned(), signed);
        write!(
            text,
            "  {with:<11} {:>6} {:>9} {:>8} {folded_mm:>8.1} {stepped_mm:>8.1} {:>8}",
            optional(mean_angle_deg),
            signed(*gap_quanta),
            signed(*gap_mm),
            optional(vote_mm)
        )?;
        match &border.decision {
            Some(Decision { yes, reason, flip, .. }) => {
                let answer = if *yes { "one thing" } else { "two things" };
                writeln!(text, "\n    {answer}: {}\n    {}", words::reason(*reason), words::flip(flip))?;
            }
            None => writeln!(text, "  structure has no vote")?,
        }
    }
    match explanation.borders.len().saturating_sub(BORDERS) {
        0 => Ok(()),
        more => writeln!(text, "  and {more} shorter ones, which --json lists"),
    }
}
