//! Functions longer than a screen, and files longer than somebody reads in one go.

use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Block, Expr, ImplItemFn, ItemFn, Signature, Stmt, TraitItemFn};

use super::Module;

/// Lines from the signature to the closing brace.
const FUNCTION_LINES: usize = 60;
/// Lines of a file, tests not counted.
const FILE_LINES: usize = 450;

/// Says which functions and files are too long.
pub(crate) fn complaints(modules: &[Module]) -> Vec<String> {
    let mut complaints = Vec::new();
    for module in modules {
        let file = module.file.display();
        for Function { name, line, lines } in long_functions(module) {
            complaints.push(format!(
                "{file}:{line}: the function {name} has {lines} lines; at most {FUNCTION_LINES} fit on a screen"
            ));
        }
        if module.lines > FILE_LINES {
            complaints.push(format!(
                "{file}: {} lines without its tests; at most {FILE_LINES} are allowed",
                module.lines
            ));
        }
    }
    complaints
}

struct Function {
    name: String,
    /// Where it begins.
    line: usize,
    lines: usize,
}

fn long_functions(module: &Module) -> Vec<Function> {
    let mut finder = Finder(Vec::new());
    module.items.iter().for_each(|item| finder.visit_item(item));
    finder.0
}

struct Finder(Vec<Function>);

impl Finder {
    fn look_at(&mut self, signature: &Signature, body: &Block) {
        let (line, end) = (signature.span().start().line, body.span().end().line);
        let lines = end - line + 1;
        if lines > FUNCTION_LINES && !is_table(body) {
            self.0.push(Function { name: signature.ident.to_string(), line, lines });
        }
    }
}

impl<'ast> Visit<'ast> for Finder {
    fn visit_item_fn(&mut self, function: &'ast ItemFn) {
        self.look_at(&function.sig, &function.block);
        visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast ImplItemFn) {
        self.look_at(&function.sig, &function.block);
        visit::visit_impl_item_fn(self, function);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast TraitItemFn) {
        if let Some(body) = &function.default {
            self.look_at(&function.sig, body);
        }
        visit::visit_trait_item_fn(self, function);
    }
}

/// Whether a body only looks something up: one `match` whose arms do nothing but name a value, or one list.
fn is_table(body: &Block) -> bool {
    match &body.stmts[..] {
        [Stmt::Expr(Expr::Match(table), None)] => table.arms.iter().all(|arm| is_entry(&arm.body)),
        [Stmt::Expr(expression, None)] => is_list(expression),
        _ => false,
    }
}

/// Whether an expression has no statements of its own.
fn is_entry(expression: &Expr) -> bool {
    struct Statements(bool);
    impl<'ast> Visit<'ast> for Statements {
        fn visit_block(&mut self, _: &'ast Block) {
            self.0 = true;
        }
    }
    let mut statements = Statements(false);
    statements.visit_expr(expression);
    !statements.0
}

fn is_list(expression: &Expr) -> bool {
    match expression {
        Expr::Array(list) => list.elems.iter().all(is_entry),
        Expr::Reference(reference) => is_list(&reference.expr),
        Expr::Macro(list) => list.mac.path.is_ident("vec"),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::modules_of;

    fn names(text: &str) -> Vec<String> {
        long_functions(&modules_of(&[("a", text)])[0]).into_iter().map(|f| f.name).collect()
    }

    #[test]
    fn sixty_lines_are_allowed_and_one_more_is_not() {
        let of = |lines: usize| {
            format!("/// Words.\n#[inline]\nfn f() {{\n{}}}\n", "    g();\n".repeat(lines - 2))
        };
        assert!(names(&of(60)).is_empty());
        assert_eq!(names(&of(61)), ["f"]);
    }

    #[test]
    fn methods_defaults_and_inner_functions_are_looked_at() {
        let body = "g();\n".repeat(60);
        let text = format!(
            "impl A {{ fn a() {{\n{body}}} }}\ntrait B {{ fn b() {{\n{body}}} fn c(); }}\nmod m {{ fn d() {{ fn e() {{\n{body}}} }} }}"
        );
        assert_eq!(names(&text), ["a", "b", "d", "e"]);
    }

    #[test]
    fn long_tests_are_allowed() {
        let body = "g();\n".repeat(100);
        assert!(names(&format!("#[cfg(test)]\nmod tests {{ fn a() {{\n{body}}} }}")).is_empty());
    }

    #[test]
    fn a_table_may_be_long() {
        let arms = "1 => \"one\",\n".repeat(70);
        assert!(
            names(&format!("fn f(i: u8) -> &'static str {{\nmatch i {{\n{arms} _ => \"\" }} }}")).is_empty()
        );
        let lines = "(1, \"one\"),\n".repeat(70);
        assert!(names(&format!("fn f() -> [(u8, &'static str); 70] {{\n[{lines}]\n}}")).is_empty());
    }

    #[test]
    fn a_match_that_works_is_no_table() {
        let arms = "1 => { g(); h() }\n".repeat(70);
        assert_eq!(names(&format!("fn f(i: u8) {{\nmatch i {{\n{arms} _ => g() }} }}")), ["f"]);
        let arms = "1 => \"one\",\n".repeat(70);
        assert_eq!(names(&format!("fn f(i: u8) {{\ng();\nmatch i {{\n{arms} _ => \"\" }} }}")), ["f"]);
    }

    #[test]
    fn a_long_file_is_said_with_its_lines() {
        let text = "const A: u8 = 1;\n".repeat(451);
        let said = complaints(&modules_of(&[("room::a", &text), ("b", &text[17..])]));
        assert_eq!(said, ["room/a.rs: 451 lines without its tests; at most 450 are allowed"]);
    }
}
