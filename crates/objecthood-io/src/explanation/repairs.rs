//! What would change the answer for a pixel or two: the search for repairs as text, and as a file of JSON.

use std::fmt::Write;

use objecthood::Params;
use objecthood::explain::{Belonging, Others, Pixels, Repair, RepairSearch, Value};
use serde::Serialize;

use super::Origin;
use super::words::share;
use crate::error::Result;
use crate::json;

/// Version of the form that is written.
const VERSION: u32 = 1;

/// A [`RepairSearch`] with what it is of.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RepairFile<'a> {
    /// Version of this form: 1.
    pub repair_version: u32,
    /// What it is of.
    #[serde(flatten)]
    pub origin: Origin<'a>,
    /// The search.
    #[serde(flatten)]
    pub search: &'a RepairSearch,
}

impl<'a> RepairFile<'a> {
    /// Of a frame, named as the user would.
    pub fn new(input: &'a str, params: &Params, search: &'a RepairSearch) -> Self {
        Self { repair_version: VERSION, origin: Origin::new(input, params), search }
    }

    /// As JSON that ends with a line end.
    ///
    /// # Errors
    /// [`Error::NotFinite`](crate::Error::NotFinite) names the place of a value that JSON cannot hold.
    pub fn to_json(&self) -> Result<String> {
        json::pretty(self)
    }
}

/// The search for a terminal: `input` is what the user calls the frame.
pub fn repairs_in_words(input: &str, search: &RepairSearch) -> String {
    let mut text = format!("{input}: {}.\n", answer(search.pixels, search.now));
    let (what, tried) = (sought(search.now), search.tried);
    if search.found.is_empty() {
        let _ = writeln!(text, "No value that was tried {what}: of {tried} parameters, one at a time.");
        return text;
    }
    let _ =
        writeln!(text, "What {what}, of {tried} parameters that were tried one at a time, the best first:");
    for Repair { parameter, from, to, others, .. } in &search.found {
        let percent = match (from, to) {
            (Value::Number(from), Value::Number(to)) => share(*from, *to),
            _ => String::new(),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  --set {parameter}={to} (now {from}{percent}): {}", side_effects(*others));
    }
    text
}

/// The present answer, as a sentence without its point.
fn answer(pixels: Pixels, now: Belonging) -> String {
    let [u, v] = pixels.pixel;
    let [s, t] = pixels.with.unwrap_or(pixels.pixel);
    let of = |object: u16| if object == 0 { "no object".to_owned() } else { format!("object {object}") };
    match now {
        Belonging::NoObject => format!("pixel {u},{v} is in no object"),
        Belonging::Object { object } => format!("pixel {u},{v} is in object {object}"),
        Belonging::OneObject { object } => format!("pixels {u},{v} and {s},{t} are in one object, {object}"),
        Belonging::TwoObjects { objects: [a, b] } => {
            format!("pixels {u},{v} and {s},{t} are in two objects, {a} and {b}")
        }
        Belonging::NotBoth { objects: [a, b] } => {
            format!("pixel {u},{v} is in {}, and pixel {s},{t} in {}", of(a), of(b))
        }
    }
}

/// What a repair does, as the end of a sentence.
pub fn sought(now: Belonging) -> &'static str {
    match now {
        Belonging::NoObject => "makes it an object",
        Belonging::Object { .. } => "makes it no object",
        Belonging::OneObject { .. } => "parts them",
        Belonging::TwoObjects { .. } | Belonging::NotBoth { .. } => "makes them one object",
    }
}

/// How many other objects a change makes come, go and change.
pub fn side_effects(others: Others) -> String {
    let Others { came, went, altered, .. } = others;
    let some = [(went, ["goes", "go"]), (came, ["comes", "come"]), (altered, ["changes", "change"])];
    let some: Vec<(usize, &str)> = some
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|&(count, [one, more])| (count, if count == 1 { one } else { more }))
        .collect();
    let Some((&(count, does), rest)) = some.split_first() else {
        return "no other object changes".to_owned();
    };
    let objects = if count == 1 { "object" } else { "objects" };
    let rest: String = rest.iter().map(|(count, does)| format!(", {count} {does}")).collect();
    format!("{count} other {objects} {does}{rest}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(now: Belonging, found: Vec<Repair>) -> RepairSearch {
        let pixels = Pixels { pixel: [1, 2], with: Some([3, 4]) };
        RepairSearch { pixels, now, tried: 90, left: Vec::new(), found }
    }

    #[test]
    fn what_is_found_can_be_set() {
        let repair = |parameter: &str, from, to, others| Repair {
            parameter: parameter.to_owned(),
            from,
            to,
            change: 1.0,
            others,
        };
        let found = vec![
            repair("necks.color_overlap", Value::Number(0.2), Value::Number(0.4), Others::default()),
            repair(
                "flat.enabled",
                Value::Switch(true),
                Value::Switch(false),
                Others { came: 1, went: 2, altered: 0 },
            ),
        ];
        assert_eq!(
            repairs_in_words("a.pcd", &search(Belonging::TwoObjects { objects: [5, 6] }, found)),
            "a.pcd: pixels 1,2 and 3,4 are in two objects, 5 and 6.\n\
             What makes them one object, of 90 parameters that were tried one at a time, the best first:\n  \
             --set necks.color_overlap=0.4 (now 0.2, +100.0 %): no other object changes\n  \
             --set flat.enabled=false (now true): 2 other objects go, 1 comes\n"
        );
        assert_eq!(
            repairs_in_words("a.pcd", &search(Belonging::OneObject { object: 5 }, Vec::new())),
            "a.pcd: pixels 1,2 and 3,4 are in one object, 5.\n\
             No value that was tried parts them: of 90 parameters, one at a time.\n"
        );
    }

    #[test]
    fn side_effects_are_counted_in_words() {
        let said = |went, came, altered| side_effects(Others { came, went, altered });
        assert_eq!(said(0, 0, 0), "no other object changes");
        assert_eq!(said(1, 0, 0), "1 other object goes");
        assert_eq!(said(0, 1, 0), "1 other object comes");
        assert_eq!(said(1, 2, 0), "1 other object goes, 2 come");
        assert_eq!(said(0, 3, 1), "3 other objects come, 1 changes");
        assert_eq!(said(0, 0, 2), "2 other objects change");
    }
}
