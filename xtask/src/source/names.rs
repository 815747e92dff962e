//! What the code of one file names of its own crate.

use proc_macro2::{Ident, TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Attribute, ItemMod, ItemUse, Macro, UseTree, Visibility};

use super::{Module, declared};

/// A path from the root of the crate, `["surface", "moments", "Model"]`, or one as it is written.
pub(crate) type Path = Vec<String>;

/// A name that a `use` brings into a file.
pub(crate) struct Used {
    pub(crate) name: String,
    /// What it stands for, from the root of the crate.
    pub(crate) path: Path,
    line: usize,
    /// Whether others can import it from here.
    pub(crate) exported: bool,
}

/// What a file names.
pub(crate) struct Names {
    /// The module that is being read: the file's, or one within the file.
    inside: Path,
    /// The modules that the file declares with files of their own.
    children: Vec<String>,
    pub(crate) uses: Vec<Used>,
    /// Paths in code and where they are, from the root of the crate.
    absolute: Vec<(Path, usize)>,
    /// Paths in code as they are written, of which the first name may be one that a `use` has brought.
    relative: Vec<(Path, usize)>,
}

impl Names {
    pub(crate) fn of(module: &Module) -> Self {
        let mut names = Self {
            inside: module.path.clone(),
            children: declared(&module.items),
            uses: Vec::new(),
            absolute: Vec::new(),
            relative: Vec::new(),
        };
        module.items.iter().for_each(|item| names.visit_item(item));
        names
    }

    /// Everything that the file needs: paths from the root of the crate with their lines, in the order of the lines.
    pub(crate) fn needed(self) -> Vec<(Path, usize)> {
        let imported =
            self.uses.iter().filter(|used| !used.exported).map(|used| (used.path.clone(), used.line));
        let through_uses = self.relative.iter().filter_map(|(path, line)| {
            let used = self.uses.iter().find(|used| used.name == path[0])?;
            Some(([used.path.as_slice(), &path[1..]].concat(), *line))
        });
        let mut needed: Vec<_> = imported.chain(through_uses).chain(self.absolute.iter().cloned()).collect();
        needed.sort_by_key(|&(_, line)| line);
        needed
    }

    /// A written path from the root of the crate; none when its first name is no module that is known here.
    fn absolute(&self, path: &[String]) -> Option<Path> {
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => Some(rest.to_vec()),
            "self" => Some([self.inside.as_slice(), rest].concat()),
            "super" => {
                let up = path.iter().take_while(|name| *name == "super").count();
                let folder = self.inside.get(..self.inside.len().checked_sub(up)?)?;
                Some([folder, &path[up..]].concat())
            }
            child if self.children.iter().any(|name| name == child) => {
                Some([self.inside.as_slice(), path].concat())
            }
            _ => None,
        }
    }

    fn note(&mut self, path: Path, line: usize) {
        match self.absolute(&path) {
            Some(path) => self.absolute.push((path, line)),
            None => self.relative.push((path, line)),
        }
    }

    /// Notes the paths in what a macro is given.
    fn note_tokens(&mut self, tokens: TokenStream) {
        let mut path = Vec::new();
        let mut line = 0;
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                TokenTree::Ident(name) => {
                    if colons != 2 && !path.is_empty() {
                        self.note(std::mem::take(&mut path), line);
                    }
                    line = name.span().start().line;
                    path.push(name.to_string());
                    colons = 0;
                }
                TokenTree::Group(group) => self.note_tokens(group.stream()),
                _ => colons = 0,
            }
        }
        if !path.is_empty() {
            self.note(path, line);
        }
    }
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let exported = !matches!(item.vis, Visibility::Inherited);
        for Leaf { path, name, line } in leaves(&item.tree, &[]) {
            if let Some(path) = self.absolute(&path) {
                self.uses.push(Used { name, path, line, exported });
            }
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            let names: Path = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            self.note(names, path.segments[0].ident.span().start().line);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        self.visit_path(&call.path);
        self.note_tokens(call.tokens.clone());
    }

    /// Attributes, and the documentation among them, need nothing.
    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        self.inside.push(module.ident.to_string());
        visit::visit_item_mod(self, module);
        self.inside.pop();
    }
}

/// An end of a `use`: its path as written, and the name it has from then on.
struct Leaf {
    path: Path,
    name: String,
    line: usize,
}

fn leaves(tree: &UseTree, before: &[String]) -> Vec<Leaf> {
    let with = |name: &Ident| [before, &[name.to_string()]].concat();
    let leaf = |original: &Ident, new: &Ident| {
        let path = if original == "self" && !before.is_empty() { before.to_vec() } else { with(original) };
        let name = if new == "self" { before.last().cloned().unwrap_or_default() } else { new.to_string() };
        vec![Leaf { path, name, line: original.span().start().line }]
    };
    match tree {
        UseTree::Path(path) => leaves(&path.tree, &with(&path.ident)),
        UseTree::Name(name) => leaf(&name.ident, &name.ident),
        UseTree::Rename(rename) => leaf(&rename.ident, &rename.rename),
        UseTree::Glob(glob) => {
            let line = glob.star_token.spans[0].start().line;
            vec![Leaf { path: [before, &["*".to_owned()]].concat(), name: "*".to_owned(), line }]
        }
        UseTree::Group(group) => group.items.iter().flat_map(|tree| leaves(tree, before)).collect(),
    }
}
