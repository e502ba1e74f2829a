//! Every public function of `onboard-core` stands in the link probe.

use std::collections::BTreeSet;
use std::path::Path;
use syn::{ImplItem, Item, Type, Visibility};

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
            found.insert(function.sig.ident.to_string());
        }
        Item::Impl(block) if block.trait_.is_none() => {
            let Type::Path(path) = &*block.self_ty else { panic!("an impl of an unnamed type") };
            let kind = snake(&path.path.segments.last().unwrap().ident.to_string());
            for member in &block.items {
                if let ImplItem::Fn(function) = member
                    && public(&function.vis)
                {
                    found.insert(format!("{kind}_{}", function.sig.ident));
                }
            }
        }
        _ => {}
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
    let probed: BTreeSet<&str> = probe
        .lines()
        .filter_map(|line| line.strip_prefix("    ")?.split_once('('))
        .map(|(name, _)| name.split_once("__").map_or(name, |(name, _)| name))
        .map(|name| name.strip_suffix("_probe").unwrap_or(name))
        .collect();
    let missing: Vec<_> = functions.iter().filter(|name| !probed.contains(&***name)).collect();
    assert!(missing.is_empty(), "not in tests/link-probe/src/main.rs: {missing:?}");
}
