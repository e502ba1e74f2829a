//! Names in a sentence that says what there is instead of a name that is not there.

/// Names, those nearest to `name` first: at most eight, and the number of the others.
#[must_use]
pub fn nearest_first<N: AsRef<str>>(name: &str, known: &[N]) -> String {
    let mut known: Vec<&str> = known.iter().map(AsRef::as_ref).collect();
    known.sort_by_key(|it| strsim::damerau_levenshtein(name, it));
    let (nearest, others) = known.split_at(known.len().min(8));
    match others.len() {
        0 => nearest.join(", "),
        count => format!("{} and {count} more", nearest.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_names_come_first() {
        let known: Vec<String> = (0..12).map(|index| format!("det{index}")).collect();
        let told = nearest_first("dot7", &known);
        assert_eq!(told, "det7, det0, det1, det2, det3, det4, det5, det6 and 4 more");
        assert_eq!(nearest_first("x", &["b", "a"]), "b, a");
    }
}
