//! The sources of a crate as modules, read with `syn`, their tests left out.

mod circles;
mod constants;
mod imports;
mod lengths;
mod names;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use syn::spanned::Spanned;
use syn::{Attribute, ImplItem, Item};

/// The core below the folder of a checkout.
const CORE: &str = "crates/objecthood/src";

/// One file of a crate.
pub(crate) struct Module {
    /// Its path in the crate, `["surface", "moments"]`; empty for `lib.rs`.
    pub(crate) path: Vec<String>,
    /// Its file, relative to the folder of `lib.rs`.
    pub(crate) file: PathBuf,
    /// What it declares, without tests.
    pub(crate) items: Vec<Item>,
    /// How many lines it has, without tests.
    pub(crate) lines: usize,
}

/// Checks that the core is tidy: no import circles, no long functions or files, no constant that is
/// not explained. Prints what is wrong.
///
/// # Errors
/// When a source file cannot be read or parsed.
pub(crate) fn check(root: &Path) -> Result<bool> {
    let modules = read_crate(&root.join(CORE))?;
    let constants = constants::complaints(root, &modules)?;
    let complaints = [imports::complaints(&modules), lengths::complaints(&modules), constants].concat();
    for complaint in &complaints {
        println!("{complaint}\n");
    }
    println!("{CORE}: {} files, {} complaints", modules.len(), complaints.len());
    Ok(complaints.is_empty())
}

/// Reads `lib.rs` in `folder` and every module that it declares, in the order of their paths.
pub(crate) fn read_crate(folder: &Path) -> Result<Vec<Module>> {
    let mut modules = Vec::new();
    let mut open = vec![(Vec::new(), PathBuf::from("lib.rs"))];
    while let Some((path, file)) = open.pop() {
        let module = read_module(folder, path, file)?;
        for name in declared(&module.items) {
            let path = [module.path.as_slice(), &[name]].concat();
            let file = find_file(folder, &path)?;
            open.push((path, file));
        }
        modules.push(module);
    }
    modules.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(modules)
}

fn find_file(folder: &Path, path: &[String]) -> Result<PathBuf> {
    let stem: PathBuf = path.iter().collect();
    let candidates = [stem.with_extension("rs"), stem.join("mod.rs")];
    let [a, b] = candidates.each_ref().map(|file| file.display().to_string());
    let found = candidates.into_iter().find(|file| folder.join(file).is_file());
    found.with_context(|| format!("{}: neither {a} nor {b} is there", folder.display()))
}

fn read_module(folder: &Path, path: Vec<String>, file: PathBuf) -> Result<Module> {
    let full = folder.join(&file);
    let text = std::fs::read_to_string(&full).with_context(|| format!("{}", full.display()))?;
    parse_module(path, file, &text).with_context(|| format!("{} is not Rust", full.display()))
}

fn parse_module(path: Vec<String>, file: PathBuf, text: &str) -> syn::Result<Module> {
    let mut items = syn::parse_file(text)?.items;
    let tests = remove_tests(&mut items);
    Ok(Module { path, file, items, lines: text.lines().count() - tests })
}

/// Removes what is compiled for tests only; how many lines that was.
fn remove_tests(items: &mut Vec<Item>) -> usize {
    let mut lines = 0;
    items.retain_mut(|item| {
        if is_test(attributes(item)) {
            lines += height(item);
            return false;
        }
        match item {
            Item::Mod(module) => {
                lines += module.content.as_mut().map_or(0, |(_, items)| remove_tests(items));
            }
            Item::Impl(block) => block.items.retain(|item| {
                let test = matches!(item, ImplItem::Fn(f) if is_test(&f.attrs));
                lines += if test { height(item) } else { 0 };
                !test
            }),
            _ => (),
        }
        true
    });
    lines
}

/// How many lines a piece of syntax covers.
fn height(syntax: &impl Spanned) -> usize {
    let span = syntax.span();
    span.end().line - span.start().line + 1
}

/// Whether the attributes say `#[cfg(test)]`.
fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    })
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// The modules declared with a file of their own, as in `mod moments;`.
fn declared(items: &[Item]) -> Vec<String> {
    let with_file = |item: &Item| match item {
        Item::Mod(module) if module.content.is_none() => Some(module.ident.to_string()),
        _ => None,
    };
    items.iter().filter_map(with_file).collect()
}

/// Modules made of text, for tests: each a path as in `surface::moments` and its source.
#[cfg(test)]
fn modules_of(sources: &[(&str, &str)]) -> Vec<Module> {
    let parse = |&(path, text): &(&str, &str)| {
        let path: Vec<String> = path.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
        let file = if path.is_empty() {
            "lib.rs".into()
        } else {
            path.iter().collect::<PathBuf>().with_extension("rs")
        };
        parse_module(path, file, text).unwrap()
    };
    sources.iter().map(parse).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_tests_do_not_count() {
        let text = "fn a() {}\n\n#[cfg(test)]\nmod tests {\n    fn b() {}\n}\n\nimpl A {\n    #[cfg(test)]\n    fn c() {}\n}\n";
        let [module] = &modules_of(&[("a", text)])[..] else { panic!() };
        assert_eq!(module.lines, 11 - 4 - 2);
        assert_eq!(module.items.len(), 2);
    }

    #[test]
    fn other_conditions_are_no_tests() {
        let text = "#[cfg(feature = \"scalar\")]\nfn a() {}\n#[cfg(not(test))]\nfn b() {}\n";
        assert_eq!(modules_of(&[("a", text)])[0].items.len(), 2);
    }

    #[test]
    fn the_modules_of_this_crate_are_found() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/objecthood/src");
        let modules = read_crate(&folder).unwrap();
        let files: Vec<_> = modules.iter().map(|module| module.file.display().to_string()).collect();
        assert!(files.iter().any(|file| file == "lib.rs") && files.len() > 20, "{files:?}");
        assert!(!files.iter().any(|file| file.contains("testing")), "{files:?}");
    }

    #[test]
    fn a_module_without_a_file_is_said() {
        let folder = std::env::temp_dir();
        let error = find_file(&folder, &["no_such_module".to_owned()]).unwrap_err().to_string();
        assert!(error.contains("no_such_module.rs") && error.contains("no_such_module/mod.rs"), "{error}");
    }
}
