//! Names as people type them: found in letters of any case, or answered with what there is instead.

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

/// The one of `known` that a name is, in letters of any case; `None` where that fits several and none
/// exactly.
#[must_use]
pub fn in_any_case<'n, N: AsRef<str>>(name: &str, known: &'n [N]) -> Option<&'n str> {
    let mut all = known.iter().map(AsRef::as_ref);
    if let Some(same) = all.clone().find(|it| *it == name) {
        return Some(same);
    }
    let found = all.find(|it| it.eq_ignore_ascii_case(name))?;
    all.all(|it| !it.eq_ignore_ascii_case(name)).then_some(found)
}

/// The name that was meant, where one is near.
#[must_use]
pub fn meant<'n, N: AsRef<str>>(name: &str, known: &'n [N]) -> Option<&'n str> {
    let name = name.to_lowercase();
    let distance = |it: &&str| strsim::damerau_levenshtein(&name, &it.to_lowercase());
    let nearest = known.iter().map(AsRef::as_ref).min_by_key(distance)?;
    (distance(&nearest) <= 1.max(name.chars().count() / 3)).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_in_any_case_and_near_ones_meant() {
        let known = ["mars", "Jupiter", "a", "A"];
        assert_eq!(in_any_case("MARS", &known), Some("mars"));
        assert_eq!(in_any_case("jupiter", &known), Some("Jupiter"));
        assert_eq!(in_any_case("a", &known), Some("a"));
        assert_eq!(in_any_case("\u{e1}", &known), None);
        assert_eq!(in_any_case("b", &["B", "b "]), Some("B"));
        assert_eq!(in_any_case("x", &["X", "x"]), Some("x"));
        assert_eq!(in_any_case("Xy", &["xy", "XY"]), None);
        assert_eq!(meant("jupyter", &known), Some("Jupiter"));
        assert_eq!(meant("quasar", &known), None);
    }

    #[test]
    fn the_nearest_names_come_first() {
        let known: Vec<String> = (0..12).map(|index| format!("det{index}")).collect();
        let told = nearest_first("dot7", &known);
        assert_eq!(told, "det7, det0, det1, det2, det3, det4, det5, det6 and 4 more");
        assert_eq!(nearest_first("x", &["b", "a"]), "b, a");
    }
}
