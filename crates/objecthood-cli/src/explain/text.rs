//! An explanation in words.

use std::fmt::Write;

use objecthood::clusters::check::{Bound, Check};
use objecthood::clusters::history::Rule;
use objecthood::explain::{
    BorderReport, Decision, Explanation, Flip, ObjectReport, Outcome, Question, Reason,
};

/// So many borders are printed; a table has many.
const BORDERS: usize = 16;

/// The whole of it, for a terminal.
pub(super) fn of(input: &str, explanation: &Explanation) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut text, input, explanation);
    text
}

fn write(text: &mut String, input: &str, explanation: &Explanation) -> std::fmt::Result {
    let [u, v] = explanation.pixel;
    write!(text, "{input}: pixel {u},{v}")?;
    if let Some(depth_m) = explanation.depth_m {
        write!(text, " at {depth_m:.3} m")?;
    }
    writeln!(text, "\n{}", outcome(explanation.outcome))?;
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
        decision(text, kept)?;
    }
    section(text, "What rules did with it", &explanation.way)?;
    section(text, "What rules nearly did with it", &explanation.near_misses)?;
    if !explanation.borders.is_empty() {
        borders(text, explanation)?;
    }
    Ok(())
}

fn outcome(outcome: Outcome) -> String {
    match outcome {
        Outcome::NoDepth => {
            "nothing: the sensor measured no depth here, or what it measured is not looked at".to_owned()
        }
        Outcome::NoFacet => {
            "nothing: it was measured, but lies on no surface of merging.min_facet_px pixels, and no \
                             facet goes on to it without a step"
                .to_owned()
        }
        Outcome::Structure { plane } => {
            format!("structure plane {plane}: a large plane that carries or encloses things")
        }
        Outcome::Background { plane: 0 } => "no object: taken for a part of the background".to_owned(),
        Outcome::Background { plane } => format!("no object: taken for a part of structure plane {plane}"),
        Outcome::TooSmall => "no object: too small".to_owned(),
        Outcome::Unlikely => "no object: too little speaks for it".to_owned(),
        Outcome::Object { object } => format!("object {object}"),
    }
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

fn section(text: &mut String, title: &str, decisions: &[Decision]) -> std::fmt::Result {
    if decisions.is_empty() {
        return Ok(());
    }
    writeln!(text, "\n{title}")?;
    decisions.iter().try_for_each(|found| decision(text, found))
}

fn decision(text: &mut String, decision: &Decision) -> std::fmt::Result {
    let Decision { question, yes, reason, checks, flip } = decision;
    let answer = if *yes { "yes" } else { "no" };
    match question {
        Question::OneThing { facets: [a, b] } => {
            let verb = if *yes { "are one" } else { "are two" };
            writeln!(text, "  facets {a} and {b} {verb}: {}", in_words(*reason))?;
        }
        Question::Kept { .. } | Question::OfObject { .. } => {
            writeln!(text, "  {answer}: {}", in_words(*reason))?;
        }
        Question::Bottom { facet, patch: [u, v] } => {
            let verb = if *yes { "belongs" } else { "does not belong" };
            writeln!(
                text,
                "  the patch of the table that begins at {u},{v} {verb} to facet {facet}: {}",
                in_words(*reason)
            )?;
        }
    }
    checks.iter().try_for_each(|check| writeln!(text, "    {}", checked(check)))?;
    writeln!(text, "    {}", flipped(flip))
}

fn in_words(reason: Reason) -> &'static str {
    match reason {
        Reason::Folds => "the folds of their border",
        Reason::Steps => "the steps of their border",
        Reason::OtherBorders => "other borders outvote their own",
        Reason::Size => "too few pixels",
        Reason::Structure => "it lies on a large plane that carries or encloses things",
        Reason::Objectness => "too little speaks for it",
        Reason::Passed => "nothing speaks against it",
        Reason::Rule(Rule::Fragment) => "a fragment goes to what it touches most",
        Reason::Rule(Rule::Low) => "what hardly rises above the support is a part of it",
        Reason::Rule(Rule::VesselInside) => "two pieces of the inside of a vessel",
        Reason::Rule(Rule::VesselWall) => "the inside of a vessel and the wall before it",
        Reason::Rule(Rule::VesselRim) => "within the rim of a vessel",
        Reason::Rule(Rule::VesselRemainder) => "a remainder of a vessel",
        Reason::Rule(Rule::VesselBottom) => "the bottom of a vessel",
        Reason::Rule(Rule::Occlusion) => "one surface behind something nearer",
    }
}

/// What was measured, as it lies to the limit.
fn checked(check: &Check) -> String {
    let sign = match (check.bound, check.holds()) {
        (Bound::Below, true) | (Bound::AtLeast, false) => "<",
        (Bound::AtMost, true) | (Bound::Above, false) => "<=",
        (Bound::Above, true) | (Bound::AtMost, false) => ">",
        (Bound::AtLeast, true) | (Bound::Below, false) => ">=",
    };
    let (what, unit) = (check.what, check.unit);
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let limit = match check.parameter {
        Some(parameter) => format!("{} ({parameter})", number(check.limit)),
        None => number(check.limit),
    };
    format!("{what}: {}{unit} {sign} {limit}", number(check.measured))
}

fn flipped(flip: &Flip) -> String {
    match flip {
        Flip::At { parameter, from, to, is_tight } => {
            // Of nothing there is no share.
            let change = match 100.0 * (to - from) / from.abs() {
                percent if percent.is_finite() => format!(", {percent:+.1} %"),
                _ => String::new(),
            };
            let less = if *is_tight { "" } else { "; a smaller change may do" };
            format!("otherwise with --set {parameter}={to} (now {from}{change}{less})")
        }
        Flip::Nowhere { tried } if tried.is_empty() => {
            "no value of a single parameter is known that might decide otherwise".to_owned()
        }
        Flip::Nowhere { tried } => {
            format!("tried, each alone, and none decides otherwise: {}", tried.join(", "))
        }
        Flip::NotSought => {
            "what would decide otherwise was not looked for to the end: it takes too long".to_owned()
        }
    }
}

/// With four digits, as short as they can be written.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    rounded.to_string()
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
                writeln!(text, "\n    {answer}: {}\n    {}", in_words(*reason), flipped(flip))?;
            }
            None => writeln!(text, "  structure has no vote")?,
        }
    }
    match explanation.borders.len().saturating_sub(BORDERS) {
        0 => Ok(()),
        more => writeln!(text, "  and {more} shorter ones, which --json lists"),
    }
}
