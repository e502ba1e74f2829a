//! What an option that several verbs share means to one of them.

use clap::Arg;

/// For options by their names: what their values are called, and what `--help` says of them.
pub(super) fn meaning(
    of: &'static [(&'static str, &'static str, &'static str)],
) -> impl FnMut(Arg) -> Arg {
    |option| match of.iter().find(|(name, ..)| option.get_id() == *name) {
        Some((_, value, help)) => option.value_name(*value).help(*help),
        None => option,
    }
}
