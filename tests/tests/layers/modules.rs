//! The modules of one crate, and where a name that is written in one of them is defined.
//!
//! Made from the text of the crate's files alone: each `mod` is followed to its file, each `use` is
//! kept as the name it brings and the path it stands for.
//!
//! A path is looked up as the compiler does it: `crate`, `super`, `self`, then modules, items and
//! imported names; a re-export is followed to the definition. What is under `#[cfg(test)]` is left
//! out.
//!
//! Limits: a path ends at the first name that is not a module, so `Kind::Variant` and `Kind::new` are
//! found where `Kind` is; names of other crates, and those that a macro makes, are not found.

use super::imports::{self, Use};
use std::collections::{BTreeMap, BTreeSet};
use syn::{Attribute, Item};

/// Texts by path, with `/` between folders.
pub type Sources = BTreeMap<String, String>;

/// One module.
pub struct Module {
    /// The file that it stands in.
    pub file: String,
    parent: Option<usize>,
    children: BTreeMap<String, usize>,
    items: BTreeSet<String>,
    /// What its `use` declarations bring.
    pub uses: Vec<Use>,
    /// Paths that its code names.
    pub paths: BTreeSet<Vec<String>>,
}

/// What a path leads to.
#[derive(Clone, Debug, PartialEq)]
pub enum Found {
    /// A module, by its number.
    Module(usize),
    /// Something else: the number of the module that defines it, and its name there.
    Item(usize, String),
}

/// All modules below one root.
pub struct Crate {
    /// The root comes first.
    pub modules: Vec<Module>,
}

impl Crate {
    /// Reads the crate whose root is the file `root`.
    pub fn read(sources: &Sources, root: &str) -> Self {
        let mut it = Self { modules: Vec::new() };
        let folder = root.rsplit_once('/').map_or("", |(folder, _)| folder);
        let items = parse(sources, root);
        it.add(sources, None, (root, folder), &items);
        it
    }

    /// Adds a module of `file`, whose children stand in `folder`.
    fn add(
        &mut self,
        sources: &Sources,
        parent: Option<usize>,
        (file, folder): (&str, &str),
        items: &[Item],
    ) -> usize {
        let at = self.modules.len();
        self.modules.push(Module {
            file: file.into(),
            parent,
            children: BTreeMap::new(),
            items: BTreeSet::new(),
            uses: Vec::new(),
            paths: BTreeSet::new(),
        });
        for item in items.iter().filter(|item| !only_in_tests(attributes(item))) {
            let Item::Mod(module) = item else {
                let this = &mut self.modules[at];
                this.items.extend(name(item));
                imports::collect(item, &mut this.uses, &mut this.paths);
                continue;
            };
            let name = module.ident.to_string();
            let below = format!("{folder}/{name}");
            let child = if let Some((_, items)) = &module.content {
                self.add(sources, Some(at), (file, &below), items)
            } else {
                let file = [format!("{below}.rs"), format!("{below}/mod.rs")]
                    .into_iter()
                    .find(|file| sources.contains_key(file))
                    .unwrap_or_else(|| panic!("no file of module {name} in {folder}"));
                let items = parse(sources, &file);
                self.add(sources, Some(at), (&file, &below), &items)
            };
            self.modules[at].children.insert(name, child);
        }
        at
    }

    /// What `path`, written in module `from`, leads to; none for another crate's.
    pub fn resolve(&self, from: usize, path: &[String]) -> Option<Found> {
        self.resolve_as(from, path, false, &mut BTreeSet::new())
    }

    /// `resolve`, where of a module and an item of one name `as_module` says which is meant; `seen`
    /// ends names that stand for themselves.
    fn resolve_as(
        &self,
        from: usize,
        path: &[String],
        as_module: bool,
        seen: &mut BTreeSet<(usize, Vec<String>, bool)>,
    ) -> Option<Found> {
        if !seen.insert((from, path.to_vec(), as_module)) {
            return None;
        }
        let mut at = from;
        let mut rest = path;
        while let Some((first, after)) = rest.split_first() {
            at = match first.as_str() {
                "crate" => 0,
                "self" => at,
                "super" => self.modules[at].parent?,
                _ => break,
            };
            rest = after;
        }
        let Some((name, after)) = rest.split_first() else { return Some(Found::Module(at)) };
        let module = &self.modules[at];
        let child = module.children.get(name).copied();
        let item = module.items.contains(name).then(|| Found::Item(at, name.clone()));
        let is_module = as_module || !after.is_empty();
        if is_module && let Some(child) = child {
            return self.below(child, after, as_module, seen);
        }
        if !is_module && item.is_some() {
            return item;
        }
        for it in module.uses.iter().filter(|it| it.name.as_deref() == Some(name)) {
            match self.resolve_as(at, &it.path, is_module, seen) {
                Some(Found::Module(module)) => return self.below(module, after, as_module, seen),
                Some(found) => return Some(found),
                None => {}
            }
        }
        if item.is_some() {
            return item;
        }
        if let Some(child) = child {
            return Some(Found::Module(child));
        }
        module.uses.iter().filter(|it| it.name.is_none()).find_map(|glob| {
            match self.resolve_as(at, &glob.path, true, seen)? {
                Found::Module(module) => self.resolve_as(module, rest, as_module, seen),
                Found::Item(..) => None,
            }
        })
    }

    fn below(
        &self,
        module: usize,
        rest: &[String],
        as_module: bool,
        seen: &mut BTreeSet<(usize, Vec<String>, bool)>,
    ) -> Option<Found> {
        if rest.is_empty() {
            Some(Found::Module(module))
        } else {
            self.resolve_as(module, rest, as_module, seen)
        }
    }
}

fn parse(sources: &Sources, file: &str) -> Vec<Item> {
    let text = sources.get(file).unwrap_or_else(|| panic!("{file} was not read"));
    syn::parse_file(text).unwrap_or_else(|error| panic!("{file}: {error}")).items
}

/// Whether `#[cfg(test)]`, or an `all` with it, stands there.
pub fn only_in_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().filter(|it| it.path().is_ident("cfg")).any(|it| {
        let mut test = false;
        // `not(test)` is left unread; what is no list of words is no `test` either.
        let _ = it.parse_nested_meta(|meta| {
            if meta.path.is_ident("all") {
                return meta.parse_nested_meta(|inner| {
                    test |= inner.path.is_ident("test");
                    Ok(())
                });
            }
            test |= meta.path.is_ident("test");
            Ok(())
        });
        test
    })
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(it) => &it.attrs,
        Item::Enum(it) => &it.attrs,
        Item::Fn(it) => &it.attrs,
        Item::Impl(it) => &it.attrs,
        Item::Macro(it) => &it.attrs,
        Item::Mod(it) => &it.attrs,
        Item::Static(it) => &it.attrs,
        Item::Struct(it) => &it.attrs,
        Item::Trait(it) => &it.attrs,
        Item::Type(it) => &it.attrs,
        Item::Union(it) => &it.attrs,
        Item::Use(it) => &it.attrs,
        _ => &[],
    }
}

/// The name that an item defines in its module.
fn name(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(it) => &it.ident,
        Item::Enum(it) => &it.ident,
        Item::Fn(it) => &it.sig.ident,
        Item::Macro(it) => it.ident.as_ref()?,
        Item::Static(it) => &it.ident,
        Item::Struct(it) => &it.ident,
        Item::Trait(it) => &it.ident,
        Item::Type(it) => &it.ident,
        Item::Union(it) => &it.ident,
        _ => return None,
    };
    Some(name.to_string())
}
