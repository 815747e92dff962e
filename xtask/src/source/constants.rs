//! The list of the core's constants: what each number is, in a sentence.
//!
//! [`LIST`] has a heading for every file and a line of a table for every constant in it: name, value, class, sentence. A constant
//! in a function or of a type is named with it, as in `Raster::MAX_PIXELS`. Constants of tests are not listed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context, Result};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{
    Expr, Ident, ImplItemConst, ImplItemFn, ItemConst, ItemFn, ItemImpl, ItemStatic, ItemTrait,
    TraitItemConst, TraitItemFn, Type,
};

use super::Module;

/// The list, relative to the root of the checkout.
const LIST: &str = "docs/NUMBERS.md";
/// What a constant can be; the list's introduction says what each means.
const CLASSES: [&str; 3] = ["derived", "definition", "representation"];
/// A longer value is not repeated in the list.
const LONGEST_VALUE: usize = 60;

/// Says where the list and the code differ.
///
/// # Errors
/// When the list cannot be read.
pub(crate) fn complaints(root: &Path, modules: &[Module]) -> Result<Vec<String>> {
    let text = std::fs::read_to_string(root.join(LIST)).with_context(|| format!("{LIST} cannot be read"))?;
    Ok(compare(&parse(&text), &constants(modules)))
}

/// A file, and the name of a constant in it.
type Key = (String, String);

/// A constant of the code.
struct Constant {
    line: usize,
    value: String,
}

/// A line of the list.
struct Entry {
    line: usize,
    value: String,
    class: String,
    sentence: String,
}

/// The entries of the list by key, with those that stand twice.
type Entries = BTreeMap<Key, Vec<Entry>>;

fn compare(entries: &Entries, constants: &BTreeMap<Key, Constant>) -> Vec<String> {
    let unlisted = constants.iter().filter(|(key, _)| !entries.contains_key(*key));
    let unlisted = unlisted.map(|((file, name), constant)| {
        let line = format!("| `{name}` | {} | CLASS | SENTENCE |", cell(&constant.value));
        let elsewhere = entries.iter().find(|((_, other), _)| other == name);
        let elsewhere = elsewhere.filter(|(key, _)| !constants.contains_key(*key));
        let advice = match elsewhere {
            Some(((old, _), entry)) => {
                format!("It is listed under `## {old}`, line {}: move that line under `## {file}`.", entry[0].line)
            }
            None => format!(
                "Add under `## {file}`, with its class ({}) and what it means and why it has this value:\n{line}",
                CLASSES.join(", ")
            ),
        };
        format!("{file}:{}: the constant {name} is not in {LIST}. {advice}", constant.line)
    });
    let listed = entries.iter().flat_map(|(key, entries)| entries.iter().enumerate().map(move |e| (key, e)));
    let wrong = listed.filter_map(|((file, name), (i, entry))| {
        let fault = match constants.get(&(file.clone(), name.clone())) {
            _ if i > 0 => "stands twice: remove one line".to_owned(),
            None => format!("is no constant of {file}: remove the line, or move it to the file that has it"),
            Some(constant) => fault(entry, constant)?,
        };
        Some(format!("{LIST}:{}: {name} {fault}", entry.line))
    });
    unlisted.chain(wrong).chain(shared(entries)).collect()
}

/// What is wrong with an entry of a constant that exists.
fn fault(entry: &Entry, constant: &Constant) -> Option<String> {
    let value = cell(&constant.value);
    if entry.value != value {
        return Some(format!(
            "has the value {value} in the code: write that, and check that its sentence still holds"
        ));
    }
    if !CLASSES.contains(&entry.class.as_str()) {
        return Some(format!("has the class {:?}: write one of {}", entry.class, CLASSES.join(", ")));
    }
    let is_sentence = entry.sentence.ends_with('.') && entry.sentence.split_whitespace().count() > 3;
    (!is_sentence).then(|| "has no sentence: write what it means and why it has this value".to_owned())
}

/// Sentences that stand at several constants.
fn shared(entries: &Entries) -> Vec<String> {
    let mut seen = BTreeSet::new();
    let all = entries.iter().flat_map(|((_, name), entries)| entries.iter().map(move |entry| (name, entry)));
    let again = all.filter(|(_, entry)| !entry.sentence.is_empty() && !seen.insert(entry.sentence.clone()));
    again
        .map(|(name, entry)| {
            format!(
                "{LIST}:{}: {name} has the sentence of another constant: write one of its own",
                entry.line
            )
        })
        .collect()
}

/// A value as it stands in the list.
fn cell(value: &str) -> String {
    let value = value.split_whitespace().collect::<Vec<_>>().join(" ");
    if value.len() > LONGEST_VALUE {
        "(table)".to_owned()
    } else {
        format!("`{}`", value.replace('|', "\\|"))
    }
}

/// Reads the list.
fn parse(text: &str) -> Entries {
    let mut entries = Entries::new();
    let mut file = String::new();
    for (i, line) in text.lines().enumerate() {
        if let Some(heading) = line.strip_prefix("## ") {
            file = heading.trim().to_owned();
        }
        let Some(row) = line.strip_prefix("| `") else { continue };
        let mut cells = cells(row);
        cells.resize(4, String::new());
        let [name, value, class, sentence] = cells.try_into().unwrap_or_default();
        let name = name.trim_end_matches('`').to_owned();
        let entry = Entry { line: i + 1, value, class, sentence };
        entries.entry((file.clone(), name)).or_default().push(entry);
    }
    entries
}

/// The cells of a row of a table; `\|` is no border.
fn cells(row: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    for part in row.trim_end().trim_end_matches('|').split('|') {
        let last = cells.len() - 1;
        if cells[last].ends_with('\\') {
            cells[last] = format!("{}|{part}", cells[last]);
        } else if last == 0 && cells[0].is_empty() {
            cells[0] = part.to_owned();
        } else {
            cells.push(part.to_owned());
        }
    }
    cells.iter().map(|cell| cell.trim().to_owned()).collect()
}

/// The constants of the code.
fn constants(modules: &[Module]) -> BTreeMap<Key, Constant> {
    let mut constants = BTreeMap::new();
    for module in modules {
        let mut finder = Finder::default();
        module.items.iter().for_each(|item| finder.visit_item(item));
        let file = module.file.display().to_string();
        constants.extend(finder.found.into_iter().map(|(name, constant)| ((file.clone(), name), constant)));
    }
    constants
}

#[derive(Default)]
struct Finder {
    /// The function or type that is being read.
    inside: Option<String>,
    found: Vec<(String, Constant)>,
}

impl Finder {
    fn note(&mut self, name: &Ident, value: &Expr) {
        let owner = self.inside.as_ref().map_or_else(String::new, |owner| format!("{owner}::"));
        let value = value.span().source_text().unwrap_or_default();
        self.found.push((format!("{owner}{name}"), Constant { line: name.span().start().line, value }));
    }

    fn within(&mut self, owner: String, visit: impl FnOnce(&mut Self)) {
        let outside = self.inside.replace(owner);
        visit(self);
        self.inside = outside;
    }
}

impl<'ast> Visit<'ast> for Finder {
    fn visit_item_const(&mut self, item: &'ast ItemConst) {
        self.note(&item.ident, &item.expr);
    }

    fn visit_item_static(&mut self, item: &'ast ItemStatic) {
        self.note(&item.ident, &item.expr);
    }

    fn visit_impl_item_const(&mut self, item: &'ast ImplItemConst) {
        self.note(&item.ident, &item.expr);
    }

    fn visit_trait_item_const(&mut self, item: &'ast TraitItemConst) {
        if let Some((_, value)) = &item.default {
            self.note(&item.ident, value);
        }
    }

    fn visit_item_fn(&mut self, item: &'ast ItemFn) {
        self.within(item.sig.ident.to_string(), |finder| visit::visit_item_fn(finder, item));
    }

    fn visit_impl_item_fn(&mut self, item: &'ast ImplItemFn) {
        self.within(item.sig.ident.to_string(), |finder| visit::visit_impl_item_fn(finder, item));
    }

    fn visit_trait_item_fn(&mut self, item: &'ast TraitItemFn) {
        self.within(item.sig.ident.to_string(), |finder| visit::visit_trait_item_fn(finder, item));
    }

    fn visit_item_impl(&mut self, item: &'ast ItemImpl) {
        let owner = match &*item.self_ty {
            Type::Path(path) => path.path.segments.last().map(|segment| segment.ident.to_string()),
            _ => None,
        };
        self.within(owner.unwrap_or_default(), |finder| visit::visit_item_impl(finder, item));
    }

    fn visit_item_trait(&mut self, item: &'ast ItemTrait) {
        self.within(item.ident.to_string(), |finder| visit::visit_item_trait(finder, item));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::modules_of;

    const CODE: &str = "const A: f64 = 2.0 *\n    B;\nimpl Raster<u8> { pub const B: u8 = 1; fn f() { const C: &str = \"a | b\"; } }\n\
                        #[cfg(test)] mod tests { const D: u8 = 1; }";
    const TABLE: &str = "## room/a.rs\n\n| constant | value | class | sentence |\n|---|---|---|---|\n\
                         | `A` | `2.0 * B` | derived | Twice the B of a raster. |\n\
                         | `Raster::B` | `1` | definition | The B of a raster, because it is so. |\n\
                         | `f::C` | `\"a \\| b\"` | representation | Between the a and the b. |\n";

    fn said(code: &str, table: &str) -> Vec<String> {
        compare(&parse(table), &constants(&modules_of(&[("room::a", code)])))
    }

    #[test]
    fn a_list_that_is_complete_has_no_fault() {
        assert!(said(CODE, TABLE).is_empty(), "{:?}", said(CODE, TABLE));
    }

    #[test]
    fn a_constant_that_is_not_listed_is_said_with_the_line_to_add() {
        let table = TABLE.replace("| `f::C`", "| f::C");
        let [said] = &said(CODE, &table)[..] else { panic!() };
        assert!(said.starts_with("room/a.rs:3: the constant f::C is not in docs/NUMBERS.md."), "{said}");
        assert!(said.ends_with("| `f::C` | `\"a \\| b\"` | CLASS | SENTENCE |"), "{said}");
    }

    #[test]
    fn a_constant_that_is_gone_is_said() {
        let said = said(&CODE.replace("pub const B: u8 = 1;", ""), TABLE);
        assert_eq!(
            said,
            [
                "docs/NUMBERS.md:6: Raster::B is no constant of room/a.rs: remove the line, or move it to the file that has it"
            ]
        );
    }

    #[test]
    fn a_constant_that_moved_is_said_with_both_files() {
        let said = said(CODE, &TABLE.replace("## room/a.rs", "## room/b.rs"));
        assert!(
            said[0].contains("room/a.rs:1: the constant A")
                && said[0].contains("listed under `## room/b.rs`, line 5"),
            "{said:?}"
        );
    }

    #[test]
    fn another_value_is_said() {
        let [said] = &said(&CODE.replace("u8 = 1; fn", "u8 = 2; fn"), TABLE)[..] else { panic!() };
        assert!(said.contains("Raster::B has the value `2` in the code"), "{said}");
    }

    #[test]
    fn every_entry_has_a_class_and_a_sentence_of_its_own() {
        for (right, wrong, complaint) in [
            ("definition", "parameter", "has the class \"parameter\""),
            ("definition", "", "has the class \"\""),
            ("Between the a and the b.", "", "has no sentence"),
            ("Between the a and the b.", "The same.", "has no sentence"),
            ("Between the a and the b.", "Twice the B of a raster.", "has the sentence of another constant"),
        ] {
            let said = said(CODE, &TABLE.replace(right, wrong));
            assert!(said.len() == 1 && said[0].contains(complaint), "{said:?}");
        }
    }

    #[test]
    fn an_entry_that_stands_twice_is_said() {
        let table = format!("{TABLE}| `A` | `2.0 * B` | derived | Again twice the B. |\n");
        assert_eq!(said(CODE, &table), ["docs/NUMBERS.md:8: A stands twice: remove one line"]);
    }
}
