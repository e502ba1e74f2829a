//! Every public function of `onboard-core` stands in the link probe; one with const parameters, its
//! own or its type's, stands there twice: at capacity 1 (`name__1`) and at the largest (`name__max`).
//!
//! Requirements: REQ-CORE-1.

use std::collections::BTreeSet;
use std::path::Path;
use syn::{Generics, ImplItem, Item, Type, Visibility};

/// Names as the probe spells them: `type_function`, or the function's own name.
fn public_functions(folder: &Path, found: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            public_functions(&path, found);
        } else {
            let file = syn::parse_file(&std::fs::read_to_string(&path).unwrap()).unwrap();
            file.items.iter().for_each(|item| collect(item, found));
        }
    }
}

fn collect(item: &Item, found: &mut BTreeSet<String>) {
    let public = |visibility: &Visibility| matches!(visibility, Visibility::Public(_));
    match item {
        Item::Fn(function) if public(&function.vis) => {
            insert(function.sig.ident.to_string(), &[&function.sig.generics], found);
        }
        Item::Impl(block) if block.trait_.is_none() => {
            let Type::Path(path) = &*block.self_ty else { panic!("an impl of an unnamed type") };
            let kind = snake(&path.path.segments.last().unwrap().ident.to_string());
            for member in &block.items {
                if let ImplItem::Fn(function) = member
                    && public(&function.vis)
                {
                    let name = format!("{kind}_{}", function.sig.ident);
                    insert(name, &[&block.generics, &function.sig.generics], found);
                }
            }
        }
        _ => {}
    }
}

fn insert(name: String, generics: &[&Generics], found: &mut BTreeSet<String>) {
    if generics.iter().any(|generics| generics.const_params().next().is_some()) {
        found.extend([format!("{name}__1"), format!("{name}__max")]);
    } else {
        found.insert(name);
    }
}

fn snake(name: &str) -> String {
    let mut snake = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

#[test]
fn no_public_function_is_missing_from_the_probe() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut functions = BTreeSet::new();
    public_functions(&root.join("../onboard-core/src"), &mut functions);
    assert!(functions.len() > 90, "the source was not read: {functions:?}");
    let probe = std::fs::read_to_string(root.join("link-probe/src/main.rs")).unwrap();
    let probed: BTreeSet<String> = probe
        .lines()
        .filter_map(|line| line.strip_prefix("    ")?.split_once('('))
        .map(|(name, _)| name.replace("_probe__", "__"))
        .map(|name| name.strip_suffix("_probe").map(String::from).unwrap_or(name))
        .collect();
    let missing: Vec<_> = functions.iter().filter(|name| !probed.contains(*name)).collect();
    assert!(missing.is_empty(), "not in tests/link-probe/src/main.rs: {missing:?}");
}

#[test]
fn const_parameters_ask_for_the_smallest_and_the_largest() {
    let source = "impl<const N: usize> Queue<N> { pub fn push(&mut self) {} fn hidden(&self) {} }
        pub fn fill<const N: usize>() {} pub fn plain<T>() {}";
    let mut found = BTreeSet::new();
    syn::parse_file(source).unwrap().items.iter().for_each(|item| collect(item, &mut found));
    let names = ["fill__1", "fill__max", "plain", "queue_push__1", "queue_push__max"];
    assert_eq!(found, names.map(String::from).into());
}
