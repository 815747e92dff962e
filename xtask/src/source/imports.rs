//! Which file of a crate needs which other, and that no file and no room needs itself in a circle.
//!
//! A file needs another when it names something that is declared there: in a `use`, in a path in its code, in a macro. What is
//! named through a re-export counts as an import of the file that declares it, however long the way. A re-export itself
//! (`pub use child::Thing`) is no import: the file lists the thing and does not need it. When the file's own code uses the
//! thing, that counts. So a `mod.rs` that re-exports its children and has no code of its own is in no circle; one whose code
//! calls a child that needs the `mod.rs` is.
//!
//! A room is a folder or file directly beside `lib.rs`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use super::Module;
use super::circles::{self, Graph};
use super::names::{Names, Path};

/// How many places of an import are named.
const PLACES: usize = 3;

/// Says which files and which rooms need each other in a circle.
pub(crate) fn complaints(modules: &[Module]) -> Vec<String> {
    let files = file_graph(modules);
    let rooms = room_graph(modules);
    [knots(&files, "files"), knots(&rooms, "rooms")].concat()
}

fn knots(graph: &Graph, of_what: &str) -> Vec<String> {
    circles::knots(graph).iter().map(|knot| knot_text(graph, knot, of_what)).collect()
}

fn knot_text(graph: &Graph, knot: &BTreeSet<String>, of_what: &str) -> String {
    let within = |edges: &BTreeMap<String, Vec<String>>| {
        edges
            .iter()
            .filter(|(to, _)| knot.contains(*to))
            .map(|(to, places)| (to.clone(), places.clone()))
            .collect()
    };
    let inside: Graph = knot.iter().map(|node| (node.clone(), within(&graph[node]))).collect();
    let cuts = circles::cuts(&inside);

    let names = knot.iter().map(String::as_str).collect::<Vec<_>>().join(" ");
    let mut text = format!("{} {of_what} import each other in circles: {names}\n", knot.len());
    let _ =
        write!(text, "without these {} imports there is no circle (one circle each is shown):", cuts.len());
    for (circle, (from, to)) in cuts {
        let _ = write!(text, "\n  {from} -> {to}, in {} -> {}", circle.join(" -> "), circle[0]);
        let places = &inside[&from][&to];
        for place in places.iter().take(PLACES) {
            let _ = write!(text, "\n      {place}");
        }
        if places.len() > PLACES {
            let _ = write!(text, "\n      and {} more", places.len() - PLACES);
        }
    }
    text
}

/// Which file needs which.
fn file_graph(modules: &[Module]) -> Graph {
    graph(modules, |module| module.file.display().to_string())
}

/// Which room needs which: a room is named by its folder or file.
fn room_graph(modules: &[Module]) -> Graph {
    graph(modules, |module| module.path.first().cloned().unwrap_or_else(|| "lib.rs".to_owned()))
}

fn graph(modules: &[Module], node: impl Fn(&Module) -> String) -> Graph {
    let map = Map::new(modules);
    let mut graph: Graph = modules.iter().map(|module| (node(module), BTreeMap::new())).collect();
    for module in modules {
        for Import { to, name, line } in map.imports(module) {
            let (from, to) = (node(module), node(to));
            if from != to {
                let place = format!("{}:{line} names {name}", module.file.display());
                graph.entry(from).or_default().entry(to).or_default().push(place);
            }
        }
    }
    graph
}

/// The modules by path, with what each re-exports.
struct Map<'a> {
    modules: BTreeMap<&'a [String], &'a Module>,
    /// Where a re-exported thing comes from.
    exports: BTreeMap<Path, Path>,
}

impl<'a> Map<'a> {
    fn new(modules: &'a [Module]) -> Self {
        let exports = |module: &Module| {
            let folder = module.path.clone();
            let exported = Names::of(module).uses.into_iter().filter(|used| used.exported);
            exported.map(move |used| ([folder.as_slice(), &[used.name]].concat(), used.path))
        };
        Self {
            modules: modules.iter().map(|module| (module.path.as_slice(), module)).collect(),
            exports: modules.iter().flat_map(exports).collect(),
        }
    }

    /// The file that declares a thing, and the thing's name in it; none for a path that ends at a module.
    fn find(&self, path: &[String]) -> Option<(&'a Module, String)> {
        let mut path = path.to_vec();
        // Every step passes another re-export: they form no circle, or the crate would not compile.
        for _ in 0..=self.exports.len() {
            let length = (0..=path.len()).rev().find(|&length| self.modules.contains_key(&path[..length]))?;
            let name = path.get(length)?;
            let Some(origin) = self.exports.get(&path[..=length]) else {
                return Some((self.modules[&path[..length]], name.clone()));
            };
            path = [origin.as_slice(), &path[length + 1..]].concat();
        }
        None
    }

    /// What a file needs of which files, every thing once, with the line that names it first.
    fn imports(&self, module: &Module) -> Vec<Import<'a>> {
        let mut imports: BTreeMap<(Path, String), Import<'a>> = BTreeMap::new();
        for (path, line) in Names::of(module).needed() {
            let Some((to, name)) = self.find(&path) else { continue };
            imports.entry((to.path.clone(), name.clone())).or_insert(Import { to, name, line });
        }
        imports.into_values().collect()
    }
}

/// A thing that a file needs of another.
struct Import<'a> {
    to: &'a Module,
    name: String,
    line: usize,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::modules_of;

    /// The edges between files, as in `a>b`.
    fn edges(sources: &[(&str, &str)]) -> String {
        let graph = file_graph(&modules_of(sources));
        let text = |(from, to): (&String, &BTreeMap<String, Vec<String>>)| {
            to.keys().map(|to| format!("{from}>{to} ")).collect::<String>()
        };
        graph.iter().map(text).collect::<String>().replace(".rs", "").trim_end().to_owned()
    }

    #[test]
    fn every_way_to_name_a_thing_is_an_import() {
        for text in [
            "use crate::b::B;",
            "use crate::{b::{B as C}};",
            "use crate::b::*;",
            "use super::b::B;",
            "use crate::b; fn f(_: b::B) {}",
            "fn f() { crate::b::f(); }",
            "fn f() { use crate::b::B; }",
            "impl crate::b::B {}",
            "fn f() { println!(\"{}\", crate::b::f()); }",
            "use crate::b; fn f() { println!(\"{}\", b::f()); }",
            "macro_rules! m { () => { $crate::b::f() } }",
            "mod inner { use super::super::b::B; }",
        ] {
            assert_eq!(edges(&[("", "mod a; mod b;"), ("a", text), ("b", "")]), "a>b", "{text}");
        }
    }

    #[test]
    fn words_are_no_imports() {
        let text = "//! See [`crate::b::B`].\n/// As [`crate::b::f`].\nuse std::b::B;\nfn f(b: u8) { g(b, \"crate::b::f\") }";
        assert_eq!(edges(&[("", "mod a; mod b;"), ("a", text), ("b", "")]), "");
        let test = "#[cfg(test)] mod tests { use crate::b::B; }";
        assert_eq!(edges(&[("", "mod a; mod b;"), ("a", test), ("b", "")]), "");
    }

    #[test]
    fn a_re_export_leads_to_the_file_that_declares() {
        let sources = [
            ("", "mod a; mod room; pub use room::Thing;"),
            ("a", "use crate::room::Thing;"),
            ("room", "mod thing; pub use thing::Thing;"),
            ("room::thing", "pub struct Thing;"),
        ];
        assert_eq!(edges(&sources), "a>room/thing");
        let sources = [
            ("", "mod a; mod room; pub use room::Thing;"),
            ("a", "use crate::Thing;"),
            sources[2],
            sources[3],
        ];
        assert_eq!(edges(&sources), "a>room/thing");
    }

    #[test]
    fn a_parent_that_only_lists_its_children_is_in_no_circle() {
        let parent = "mod a; mod b; pub use a::find; pub struct Thing;";
        let sources = [
            ("", "mod room;"),
            ("room", parent),
            ("room::a", "use crate::room::Thing; use super::b::B;"),
            ("room::b", ""),
        ];
        assert_eq!(edges(&sources), "room/a>room room/a>room/b");
        assert!(complaints(&modules_of(&sources)).is_empty());
    }

    #[test]
    fn a_parent_whose_code_calls_a_child_that_needs_it_is_a_circle() {
        let parent = "mod a; pub use a::find; pub struct Thing; pub fn all() { find() }";
        let sources =
            [("", "mod room;"), ("room", parent), ("room::a", "use super::Thing; pub fn find() {}")];
        assert_eq!(
            complaints(&modules_of(&sources)),
            ["2 files import each other in circles: room.rs room/a.rs\n\
              without these 1 imports there is no circle (one circle each is shown):\n  \
              room.rs -> room/a.rs, in room.rs -> room/a.rs -> room.rs\n      \
              room.rs:1 names find"]
        );
    }

    #[test]
    fn a_circle_of_rooms_may_have_no_circle_of_files() {
        let sources = [
            ("", "mod x; mod y;"),
            ("x", "mod a; mod b;"),
            ("x::a", "use crate::y::c::C;"),
            ("x::b", "pub struct B;"),
            ("y", "mod c; mod d;"),
            ("y::c", "pub struct C;"),
            ("y::d", "use crate::x::b::B;"),
        ];
        let [said] = &complaints(&modules_of(&sources))[..] else { panic!() };
        assert!(said.starts_with("2 rooms import each other in circles: x y\n"), "{said}");
        assert!(said.contains("x/a.rs:1 names C"), "{said}");
    }

    #[test]
    fn what_lib_rs_declares_belongs_to_a_room_of_its_own() {
        let sources =
            [("", "mod a; use a::A; pub fn find(_: A) {}"), ("a", "pub struct A; fn f() { crate::find(A) }")];
        let said = complaints(&modules_of(&sources));
        assert!(
            said.iter().any(|said| said.starts_with("2 rooms import each other in circles: a lib.rs")),
            "{said:?}"
        );
    }
}
