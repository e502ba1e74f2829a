//! The check of circles, on crates made up for it.

use crate::circles::{across_folders, in_one_folder, told};
use crate::imports::{Graph, add};
use crate::modules::Sources;
use std::collections::BTreeMap;

/// The imports of a crate whose files each begin with a line `-- NAME`.
fn graph(crate_text: &str) -> Graph {
    let sources: Sources = crate_text
        .split("-- ")
        .skip(1)
        .filter_map(|file| file.split_once('\n'))
        .map(|(name, text)| (format!("src/{name}"), text.to_owned()))
        .collect();
    let mut graph = Graph::new();
    add(&sources, "src/lib.rs", &mut graph);
    graph
}

/// What one file imports, a line for each other file.
fn imports(graph: &Graph, file: &str) -> Vec<String> {
    graph[file]
        .iter()
        .map(|(other, names)| {
            format!("{other}: {}", names.iter().cloned().collect::<Vec<_>>().join(", "))
        })
        .collect()
}

/// The only circle in one folder.
fn only(graph: &Graph) -> String {
    let [circle] = &in_one_folder(graph)[..] else { panic!("{graph:?}") };
    told(graph, circle)
}

const TWO_FOLDERS: &str = "
-- lib.rs
pub mod sky;
mod world;
-- sky/mod.rs
mod map;
-- sky/map.rs
use crate::world::World;
pub struct Map(World);
fn draw() {}
-- world.rs
pub struct World;
impl World { fn show(&self) { crate::sky::map::draw() } }
";

#[test]
fn a_circle_across_folders_is_found_and_told_with_its_names() {
    let graph = graph(TWO_FOLDERS);
    let lines: Vec<_> = across_folders(&graph).iter().map(|it| told(&graph, it)).collect();
    assert_eq!(lines, ["src/sky/map.rs -> src/world.rs (World) -> src/sky/map.rs (draw)"]);
    assert!(in_one_folder(&graph).is_empty());
}

#[test]
fn lists_hold_what_stands_and_nothing_else() {
    let graph = graph(TWO_FOLDERS);
    let told = |may_stand| crate::told(&graph, &across_folders(&graph), may_stand).len();
    assert_eq!(told(&[]), 1);
    assert_eq!(told(&[&["sky/map.rs", "src/world.rs"]]), 0);
    assert_eq!(told(&[&["sky/", "src/world.rs", "src/other.rs"]]), 0);
    // Neither of these allows the circle, so it is new and they are gone.
    assert_eq!(told(&[&["sky/map.rs"], &["sky/map.rs", "world.rs"]]), 3);
    assert_eq!(told(&[&["sky/", "src/world.rs"], &["sky/"]]), 1);
}

#[test]
fn a_circle_of_three_in_one_folder_crosses_none() {
    let graph = graph(
        "
-- lib.rs
mod a; mod b; mod c; mod d;
-- a.rs
use super::b::B;
pub struct A(B);
-- b.rs
use crate::c;
pub struct B(c::C);
-- c.rs
pub struct C;
fn parent() -> Option<super::a::A> { None }
-- d.rs
use super::{a::A, b::B};
struct D(A, B);
",
    );
    assert!(across_folders(&graph).is_empty());
    assert_eq!(only(&graph), "src/a.rs -> src/b.rs (B) -> src/c.rs (C) -> src/a.rs (A)");
}

#[test]
fn a_circle_that_holds_a_smaller_one_is_not_told() {
    let graph = graph(
        "
-- lib.rs
mod a; mod b; mod c;
-- a.rs
pub struct A(crate::b::B);
-- b.rs
pub struct B(crate::c::C, crate::a::A);
-- c.rs
pub struct C(crate::a::A);
",
    );
    assert_eq!(only(&graph), "src/a.rs -> src/b.rs (B) -> src/a.rs (A)");
}

#[test]
fn a_file_beside_a_folder_of_its_name_lies_in_the_folder_of_both() {
    let graph = graph(
        "
-- lib.rs
mod fit;
-- fit.rs
mod body;
pub struct Options;
pub fn fit() { body::run(&Options) }
-- fit/body.rs
use super::Options;
pub fn run(_: &Options) {}
",
    );
    assert_eq!(across_folders(&graph).len(), 1);
    assert!(in_one_folder(&graph).is_empty());
}

#[test]
fn re_exports_are_followed_to_the_definition() {
    let graph = graph(
        "
-- lib.rs
pub mod picture; mod user; mod facade;
pub use picture::Canvas;
-- picture/mod.rs
mod canvas; mod colour;
pub use canvas::{Canvas, draw as paint};
pub(crate) use self::colour::*;
-- picture/canvas.rs
use super::Colour;
pub struct Canvas(Colour);
pub fn draw() {}
-- picture/colour.rs
pub enum Colour { Red }
pub fn mix() {}
-- facade.rs
pub use crate::picture::Canvas as Sheet;
-- user.rs
use crate::facade::Sheet;
use crate::picture::{self, Colour::Red};
fn use_all(_: Sheet) { picture::paint(); picture::mix(); Red; }
",
    );
    let used = ["src/picture/canvas.rs: Canvas, draw", "src/picture/colour.rs: Colour, mix"];
    assert_eq!(imports(&graph, "src/user.rs"), used);
    assert_eq!(imports(&graph, "src/picture/canvas.rs"), ["src/picture/colour.rs: Colour"]);
    for file in ["src/lib.rs", "src/picture/mod.rs", "src/facade.rs"] {
        assert!(graph[file].is_empty(), "{file} only passes names on");
    }
    assert!(across_folders(&graph).is_empty() && in_one_folder(&graph).is_empty());
}

#[test]
fn a_parent_that_uses_its_child_and_is_used_by_it_is_a_circle() {
    let graph = graph(
        "
-- lib.rs
mod verb;
-- verb/mod.rs
mod plan;
pub use plan::run;
pub fn tell() {}
pub fn all() { run() }
-- verb/plan.rs
pub fn run() { super::tell() }
",
    );
    let circle = "src/verb/mod.rs -> src/verb/plan.rs (run) -> src/verb/mod.rs (tell)";
    assert_eq!(only(&graph), circle);
}

#[test]
fn what_stands_under_cfg_test_does_not_count() {
    let graph = graph(
        "
-- lib.rs
mod a; mod b;
#[cfg(test)] mod whole;
-- a.rs
pub struct A;
#[cfg(test)] use crate::b::B;
#[cfg(test)] mod tests { use super::*; use crate::b::B; }
#[cfg(test)] fn made_up() -> crate::b::B { crate::b::B }
impl A { #[cfg(all(test, unix))] fn b() -> crate::b::B { crate::b::B } }
-- b.rs
use crate::a::A;
pub struct B;
#[cfg(not(test))] fn real(_: A) {}
",
    );
    assert!(graph["src/a.rs"].is_empty());
    assert_eq!(imports(&graph, "src/b.rs"), ["src/a.rs: A"]);
    assert!(!graph.contains_key("src/whole.rs"));
}

#[test]
fn names_in_macros_functions_and_inner_modules_count() {
    let graph = graph(
        r#"
-- lib.rs
mod a; mod b; mod c;
macro_rules! made { () => { $crate::a::A } }
-- a.rs
pub struct A;
pub fn f() -> u8 { 0 }
pub const LIMIT: u8 = 0;
-- b.rs
use super::a::{self, LIMIT};
fn outer() { println!("{}", a::f()); { use super::a::A; } }
mod inner { fn g() { vec![super::LIMIT]; } }
-- c.rs
use serde::a;
use std::fmt;
use crate::b;
fn g(it: X) { println!("{}", it.f); other::a::A; fmt::f(); ::a::A; self::A; a::f() }
"#,
    );
    assert_eq!(imports(&graph, "src/lib.rs"), ["src/a.rs: A"]);
    assert_eq!(imports(&graph, "src/b.rs"), ["src/a.rs: A, LIMIT, f"]);
    assert!(graph["src/c.rs"].is_empty());
}

#[test]
fn names_that_stand_for_themselves_end_the_search() {
    let graph = graph(
        "
-- lib.rs
mod a; mod b;
-- a.rs
pub use crate::b::*;
use crate::b::Nothing;
fn f() { Nobody; crate::a::Nobody; }
-- b.rs
pub use crate::a::*;
pub use crate::a::Nothing;
pub use clap::clap;
",
    );
    assert!(graph.values().all(BTreeMap::is_empty));
}
