//! Which file needs which other: every `use` that is no re-export, and every path in the code.
//!
//! Edges go from the file that names something to the file that defines it, and carry the names.
//!
//! `pub use` (also `pub(crate)` and `pub(super)`) passes a name on and needs nothing itself, and `mod`
//! declares; both count only where code names what they brought. Paths are taken from the syntax
//! tree, inside the arguments of macros from their words.
//!
//! Limits: a method that is called on a value whose type is never named is not seen, nor is a local
//! variable told from an imported function of the same name.

use super::modules::{Crate, Found, Sources, only_in_tests};
use std::collections::{BTreeMap, BTreeSet};
use syn::buffer::{Cursor, TokenBuffer};
use syn::visit::{self, Visit};
use syn::{Attribute, ImplItemFn, Item, ItemMod, ItemUse, Macro, Path, UseTree, Visibility};

/// A name that a `use` brings into its module; none for `*`.
pub struct Use {
    pub name: Option<String>,
    pub path: Vec<String>,
    /// Whether it hands the name on to other modules.
    pub re_export: bool,
}

/// From file to file, with the names that tie them.
pub type Graph = BTreeMap<String, BTreeMap<String, BTreeSet<String>>>;

/// Adds what an item imports, and the paths that it names.
pub fn collect(item: &Item, uses: &mut Vec<Use>, paths: &mut BTreeSet<Vec<String>>) {
    Names { uses, paths }.visit_item(item);
}

/// Adds the imports of the crate with the file `root`.
pub fn add(sources: &Sources, root: &str, graph: &mut Graph) {
    let whole = Crate::read(sources, root);
    for (at, module) in whole.modules.iter().enumerate() {
        let used = module.uses.iter().filter(|it| !it.re_export && it.name.is_some());
        let named = used.map(|it| &it.path).chain(&module.paths);
        let ties = graph.entry(module.file.clone()).or_default();
        for path in named {
            if let Some(Found::Item(other, name)) = whole.resolve(at, path)
                && whole.modules[other].file != module.file
            {
                ties.entry(whole.modules[other].file.clone()).or_default().insert(name);
            }
        }
    }
}

struct Names<'a> {
    uses: &'a mut Vec<Use>,
    paths: &'a mut BTreeSet<Vec<String>>,
}

impl Visit<'_> for Names<'_> {
    fn visit_attribute(&mut self, _: &Attribute) {}

    fn visit_item_mod(&mut self, _: &ItemMod) {}

    fn visit_impl_item_fn(&mut self, it: &ImplItemFn) {
        if !only_in_tests(&it.attrs) {
            visit::visit_impl_item_fn(self, it);
        }
    }

    fn visit_item_use(&mut self, it: &ItemUse) {
        if it.leading_colon.is_none() {
            let re_export = match &it.vis {
                Visibility::Inherited => false,
                Visibility::Restricted(within) => !within.path.is_ident("self"),
                Visibility::Public(_) => true,
            };
            flatten(&it.tree, &mut Vec::new(), &mut |name, path| {
                self.uses.push(Use { name, path: path.to_vec(), re_export });
            });
        }
    }

    fn visit_path(&mut self, path: &Path) {
        if path.leading_colon.is_none() {
            self.paths.insert(path.segments.iter().map(|it| it.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, it: &Macro) {
        self.visit_path(&it.path);
        words(TokenBuffer::new2(it.tokens.clone()).begin(), self.paths);
    }
}

/// Paths among the words of a macro's arguments.
fn words(mut at: Cursor, paths: &mut BTreeSet<Vec<String>>) {
    let mut member = false;
    while !at.eof() {
        if let Some((inside, _, _, after)) = at.any_group() {
            words(inside, paths);
            at = after;
            member = false;
        } else if let Some((first, mut after)) = at.ident() {
            let mut path = vec![first.to_string()];
            while let Some((next, rest)) = separated(after) {
                path.push(next);
                after = rest;
            }
            if !member {
                paths.insert(path);
            }
            at = after;
            member = false;
        } else if let Some((mark, after)) = at.punct() {
            member = mark.as_char() == '.';
            at = after;
        } else if let Some((_, after)) = at.token_tree() {
            at = after;
            member = false;
        }
    }
}

/// The word after `::`.
fn separated(at: Cursor) -> Option<(String, Cursor)> {
    let (first, at) = at.punct()?;
    let (second, at) = at.punct()?;
    let (word, at) = at.ident()?;
    (first.as_char() == ':' && second.as_char() == ':').then(|| (word.to_string(), at))
}

/// Calls `each` with every name that a tree of `use` brings.
fn flatten(
    tree: &UseTree,
    prefix: &mut Vec<String>,
    each: &mut impl FnMut(Option<String>, &[String]),
) {
    let depth = prefix.len();
    match tree {
        UseTree::Path(it) => {
            prefix.push(it.ident.to_string());
            flatten(&it.tree, prefix, each);
        }
        UseTree::Group(it) => it.items.iter().for_each(|tree| flatten(tree, prefix, each)),
        UseTree::Glob(_) => each(None, prefix),
        UseTree::Name(it) if it.ident == "self" => each(prefix.last().cloned(), prefix),
        UseTree::Name(it) => {
            prefix.push(it.ident.to_string());
            each(Some(it.ident.to_string()), prefix);
        }
        UseTree::Rename(it) => {
            if it.ident != "self" {
                prefix.push(it.ident.to_string());
            }
            each(Some(it.rename.to_string()), prefix);
        }
    }
    prefix.truncate(depth);
}
