//! `report.html`: what it says without scripts, that it is whole, alone and equal each time.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use serde_json::Value;
use std::path::Path;
use std::process::Command;

const HOSTILE: &str = "<b>&amp;<!--<script>]]>";
/// A fortnight in which Jupiter is seen.
const SPAN: &str = "span.duration_days=14";

fn plan(folder: &Path, settings: &[&str]) -> (String, Value) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"));
    command.args(["plan", "--quiet", "--out"]).arg(folder);
    for setting in settings {
        command.args(["--set", setting]);
    }
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let timeline = std::fs::read(folder.join("timeline.json")).unwrap();
    (page, serde_json::from_slice(&timeline).unwrap())
}

/// The page without what is between the tags of scripts and styles.
fn markup(page: &str) -> String {
    let mut text = String::new();
    let mut rest = page;
    while let Some((before, tag, end)) = ["<script", "<style"]
        .iter()
        .zip(["</script>", "</style>"])
        .filter_map(|(tag, end)| Some((rest.find(tag)?, *tag, end)))
        .min()
    {
        text.push_str(&rest[..before]);
        let inside = &rest[before..];
        text.push_str(&inside[..=inside.find('>').unwrap()]);
        assert!(inside.starts_with(tag));
        rest = &inside[inside.find(end).unwrap()..];
        text.push_str(end);
        rest = &rest[end.len()..];
    }
    text + rest
}

/// Every element that is opened is closed in its order; gives the names of those that were.
fn elements(page: &str) -> Vec<String> {
    const VOID: [&str; 3] = ["meta", "input", "br"];
    let text = markup(page);
    let (mut open, mut all): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    for piece in text.split('<').skip(1) {
        let mut quoted = false;
        let end = piece.find(|c| {
            quoted ^= c == '"';
            c == '>' && !quoted
        });
        let tag = &piece[..end.unwrap_or_else(|| panic!("<{piece} does not end"))];
        assert!(!piece[tag.len() + 1..].contains('>'), "a bare > after <{tag}>");
        if tag.starts_with("!DOCTYPE") {
            continue;
        }
        let name: String =
            tag.trim_start_matches('/').chars().take_while(|c| c.is_alphanumeric()).collect();
        if tag.starts_with('/') {
            assert_eq!(open.pop().as_ref(), Some(&name));
        } else {
            all.push(name.clone());
            if !VOID.contains(&name.as_str()) {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty(), "{open:?}");
    all
}

fn attributes<'p>(page: &'p str, name: &str) -> Vec<&'p str> {
    let start = format!(" {name}=\"");
    page.split(&start).skip(1).map(|it| &it[..it.find('"').unwrap()]).collect()
}

#[test]
fn the_page_holds_the_plan_without_scripts_and_without_a_network() {
    let folder = tempfile::tempdir().unwrap();
    let (page, timeline) = plan(&folder.path().join("a"), &[SPAN]);
    let text = markup(&page);
    let names = elements(&page);
    assert!(page.starts_with("<!DOCTYPE html><html lang=\"en\">"));
    assert_eq!(names.iter().filter(|it| *it == "h1").count(), 1);
    for heading in [
        "Timeline",
        "Sessions",
        "What the plan teaches",
        "Hours in view",
        "Visits",
        "Sky tracks",
        "Scan angles",
        "Rules",
        "Rejected",
        "Inputs",
    ] {
        assert!(text.contains(&format!("{heading}</h2>")), "{heading}");
    }
    // Alone: no address, nothing that loads.
    for word in
        ["http:", "https:", "//www", "src=", "url(", "@import", "<link", "<iframe", "fetch("]
    {
        assert!(!page.contains(word), "{word}");
    }
    assert!(page.contains("default-src 'none'"));
    // Every table says what it is, every figure of lines has words, every link has its place.
    let count = |name: &str| names.iter().filter(|it| *it == name).count();
    assert_eq!(count("table"), count("caption"));
    assert_eq!(count("svg"), text.matches("role=\"img\"").count());
    let ids = attributes(&text, "id");
    let mut once = ids.clone();
    once.sort_unstable();
    once.dedup();
    assert_eq!(ids.len(), once.len());
    for target in attributes(&text, "href") {
        assert!(ids.contains(&target.trim_start_matches('#')), "{target}");
    }
    for target in ["aria-labelledby", "aria-describedby", "aria-controls"]
        .map(|it| attributes(&text, it))
        .concat()
    {
        assert!(ids.contains(&target), "{target}");
    }
    let sessions = timeline["sessions"].as_array().unwrap();
    assert!(sessions.len() > 30);
    for session in sessions {
        assert!(
            text.contains(&format!("<td>{}</td>", session["id"].as_str().unwrap())),
            "{session}"
        );
    }
    for key in ["mission_sha256", "kernel_sha256", "trajectory", "program", "stopped"] {
        assert!(text.contains(timeline[key].as_str().unwrap()), "{key}");
    }
    let gap = format!("{:.3} %", 100.0 * timeline["gap"].as_f64().unwrap());
    let number = sessions.len().to_string();
    for told in [
        gap.as_str(),
        number.as_str(),
        "Constraint violations",
        "none",
        "pass",
        "max_minutes_per_day",
    ] {
        assert!(text.contains(told), "{told}");
    }
    let rejected = timeline["rejected"].as_array().unwrap().len();
    assert!(text.contains(&format!("{rejected} rejected opportunities by reason")));
    assert!(page.len() < 300_000, "{}", page.len());
    let (again, _) = plan(&folder.path().join("b"), &[SPAN]);
    assert_eq!(page, again);
}

#[test]
fn names_are_words_never_markup() {
    let folder = tempfile::tempdir().unwrap();
    let name = format!("name={}", serde_json::to_string(HOSTILE).unwrap());
    let (page, timeline) = plan(&folder.path().join("a"), &["span.duration_days=3", &name]);
    assert_eq!(timeline["mission"], HOSTILE);
    elements(&page);
    assert!(page.contains("<h1>&lt;b&gt;&amp;amp;&lt;!--&lt;script&gt;]]&gt; <span"));
    assert!(!page.contains(HOSTILE) && !page.contains("<b>"));
}

#[test]
fn a_plan_of_nothing_has_a_page_too() {
    let folder = tempfile::tempdir().unwrap();
    let settings = ["span.duration_days=0.5", "calibration.targets=[\"saturn\"]"];
    let (page, timeline) = plan(&folder.path().join("a"), &settings);
    assert!(timeline["sessions"].as_array().unwrap().is_empty());
    elements(&page);
    for told in ["There is no session", "No pass is used", "The boresight never visits it"] {
        assert!(page.contains(told), "{told}");
    }
    assert!(!page.contains("NaN") && !markup(&page).contains("inf"));
}

#[test]
fn a_broken_rule_of_periods_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let settings = ["span.duration_days=1", "scan.precession_period_min=200"];
    let (page, timeline) = plan(&folder.path().join("a"), &settings);
    assert_eq!(timeline["resonance"]["verdict"], "fail");
    assert!(markup(&page).contains("</span>FAIL</dd>"));
}

#[test]
fn the_verb_makes_the_same_page_and_holds_the_plan_against_the_rules() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a");
    let (page, timeline) = plan(&out, &[SPAN]);
    let report = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"));
        command.arg("report").arg(&out).args(["--quiet", "--set", SPAN]).args(arguments);
        let output = command.output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap(), error)
    };
    let (code, again, error) = report(&[]);
    assert_eq!((code, error.as_str()), (0, ""));
    assert_eq!(again, page);

    let (code, _, error) = report(&["--set", "scan.alpha_deg=46"]);
    assert_eq!(code, 2);
    assert!(error.contains("was planned with the mission of SHA-256"), "{error}");

    // A session twice; one of another mission; no timeline at all.
    let write = |timeline: &Value| {
        std::fs::write(out.join("timeline.json"), timeline.to_string()).unwrap();
        let _ = std::fs::remove_file(out.join("SHA256SUMS"));
    };
    let mut twice = timeline.clone();
    let first = twice["sessions"][0].clone();
    twice["sessions"].as_array_mut().unwrap().push(first);
    write(&twice);
    let (code, told, error) = report(&[]);
    assert_eq!(code, 1, "{error}");
    assert!(error.contains("is taken twice"), "{error}");
    assert!(told.contains("is taken twice") && told.contains("</span>found</dd>"));

    let mut strange = timeline.clone();
    strange["sessions"][0]["id"] = "LFT-pluto-000001".into();
    write(&strange);
    let (code, _, error) = report(&[]);
    assert_eq!(code, 2);
    assert!(error.contains("LFT-pluto-000001 is no opportunity of this mission"), "{error}");

    std::fs::write(out.join("timeline.json"), &timeline.to_string()[..500]).unwrap();
    let (code, _, error) = report(&[]);
    assert_eq!(code, 2);
    assert!(error.contains("is no timeline as plan writes it"), "{error}");
}
