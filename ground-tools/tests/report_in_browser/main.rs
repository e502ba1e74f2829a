//! `report.html` in headless Chromium: zoom, filter, keyboard, details, no network, dark, print, phone.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

mod chromium;

use chromium::Chromium;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

fn plan(settings: &[&str]) -> (TempDir, PathBuf, Value) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("plan");
    let mut command = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"));
    command.args(["plan", "--quiet", "--out"]).arg(&out);
    for setting in settings {
        command.args(["--set", setting]);
    }
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let timeline = std::fs::read(out.join("timeline.json")).unwrap();
    (folder, out.join("report.html"), serde_json::from_slice(&timeline).unwrap())
}

/// Nothing went wrong, and nothing but the page itself was asked for.
fn quiet(browser: &Chromium, page: &Path) {
    for event in &browser.events {
        let method = event["method"].as_str().unwrap_or_default();
        assert!(
            method != "Runtime.exceptionThrown" && method != "Runtime.consoleAPICalled",
            "{event}"
        );
        assert!(method != "Log.entryAdded", "{event}");
        if method == "Network.requestWillBeSent" {
            let url = event["params"]["request"]["url"].as_str().unwrap();
            // The browser draws its own controls with pictures that it holds as data.
            let own = url == format!("file://{}", page.display()) || url.starts_with("data:");
            assert!(own, "{url}");
        }
    }
}

fn length(browser: &mut Chromium) -> f64 {
    browser.number("(([a, b]) => b - a)(timeline.range())")
}

#[test]
#[ignore = "needs Chromium"]
fn the_timeline_zooms_by_key_button_wheel_and_drag() {
    let (_folder, page, timeline) = plan(&["span.duration_days=14"]);
    let sessions = timeline["sessions"].as_array().unwrap();
    let mut browser = Chromium::start(1440, 900);
    browser.open(&page);
    let whole = length(&mut browser);
    assert!((whole - 14.0 * 86_400.0).abs() < 1e-6);

    browser.value("document.getElementById('chart').focus()");
    browser.press("+");
    assert!((length(&mut browser) - whole / 2.0).abs() < 1.0);
    let from = browser.number("timeline.range()[0]");
    browser.press("ArrowRight");
    assert!(browser.number("timeline.range()[0]") > from);
    browser.press("Home");
    assert!((length(&mut browser) - whole).abs() < 1e-6);
    for _ in 0..40 {
        browser.press("+");
    }
    assert!((length(&mut browser) - 60.0).abs() < 1e-6);
    browser.press("Home");
    browser.click("[data-do=in]");
    browser.click("[data-span='86400']");
    assert!((length(&mut browser) - 86_400.0).abs() < 1.0);

    browser.click("[data-span='0']");
    browser.value("document.getElementById('chart').scrollIntoView({block: 'center'})");
    browser.value("document.getElementById('chart').focus()");
    let place = browser.value(
        "(r => [r.left + r.width / 2, r.top + r.height / 2])(document.querySelector('#chart canvas').getBoundingClientRect())",
    );
    let at = (place[0].as_f64().unwrap(), place[1].as_f64().unwrap());
    browser.mouse("mouseWheel", at, -300.0);
    let zoomed = length(&mut browser);
    assert!(zoomed < 0.5 * whole, "{zoomed}");
    let before = browser.number("timeline.range()[0]");
    browser.mouse("mousePressed", at, 0.0);
    browser.mouse("mouseMoved", (at.0 - 200.0, at.1), 0.0);
    browser.mouse("mouseReleased", (at.0 - 200.0, at.1), 0.0);
    assert!(browser.number("timeline.range()[0]") > before);

    // Every session can be reached; its details are the timeline's.
    browser.press("Home");
    assert_eq!(browser.value("plan.sessions.length"), json!(sessions.len()));
    for (index, session) in sessions.iter().enumerate() {
        browser.value(&format!("timeline.choose({index}, true)"));
        let told = browser.text("document.getElementById('details').textContent");
        let time = |key: &str| session[key].as_str().unwrap()[..19].replace('T', " ");
        for words in [
            session["id"].as_str().unwrap(),
            &format!("{} UTC, {} TDB", time("start_utc"), time("start_tdb")),
            &format!("{} UTC, {} TDB", time("end_utc"), time("end_tdb")),
            session["reason"].as_str().unwrap(),
            &format!(
                "passes{}in view{:.1} s",
                session["transits"].as_array().unwrap().len(),
                session["dwell_s"].as_f64().unwrap()
            ),
        ] {
            assert!(told.contains(words), "{words} in {told}");
        }
    }
    browser.press("Escape");
    browser.press("Home");
    browser.press("n");
    let middle = browser.value("timeline.chosen()");
    browser.press("n");
    assert_eq!(browser.value("timeline.chosen()").as_u64(), middle.as_u64().map(|it| it + 1));
    browser.press("p");
    assert_eq!(browser.value("timeline.chosen()"), middle);

    // A session in a table leads to the timeline.
    browser
        .value("document.querySelectorAll('#sessions details').forEach(it => { it.open = true; })");
    browser.click("table.sessions tbody tr:nth-child(3) td");
    let id = browser.text("document.querySelector('#details h3').textContent");
    assert_eq!(
        id,
        browser.text(
            "document.querySelector('table.sessions tbody tr:nth-child(3)').cells[0].textContent"
        )
    );
    quiet(&browser, &page);
}

#[test]
#[ignore = "needs Chromium"]
fn rejected_opportunities_are_all_there_and_filtered() {
    let (_folder, page, timeline) =
        plan(&["span.duration_days=14", "calibration.schedule.max_minutes_per_day=60"]);
    let rejected = timeline["rejected"].as_array().unwrap();
    let mut browser = Chromium::start(1440, 900);
    browser.open(&page);
    let list = browser.value(
        "[...Array(plan.count).keys()].filter(i => plan.session[i] < 0).map(i => [plan.id(i), plan.reason(i)])",
    );
    let mut told: Vec<(String, String)> = serde_json::from_value(list).unwrap();
    let mut expected: Vec<(String, String)> = rejected
        .iter()
        .map(|it| ["opportunity", "because"].map(|key| it[key].as_str().unwrap().to_owned()).into())
        .collect();
    told.sort();
    expected.sort();
    assert_eq!(told, expected);

    let count = |text: &str| {
        expected.iter().filter(|it| it.0.contains(text) || it.1.contains(text)).count()
    };
    browser.click("#by-text");
    for letter in ["H", "F", "T", "-", "j"] {
        browser.press(letter);
    }
    let matching = count("HFT-j");
    assert!(matching > 0 && matching < expected.len());
    browser.wait(&format!("rejected.count() === {matching}"));
    let rows = browser.number("document.querySelectorAll('#rejected-list tbody tr').length");
    assert!(rows > 0.0 && rows <= 50.0);
    let words = browser.text("document.getElementById('matches').textContent");
    assert!(words.starts_with(&format!("{matching} of {} rejected", expected.len())), "{words}");
    browser.click("#filters [type=reset]");
    browser.wait(&format!("rejected.count() === {}", expected.len()));
    browser.click("[data-page=last]");
    let id = browser
        .text("document.querySelector('#rejected-list tbody tr:last-child').cells[0].textContent");
    browser.click("[data-page=first]");
    assert_ne!(
        id,
        browser.text(
            "document.querySelector('#rejected-list tbody tr:last-child').cells[0].textContent"
        )
    );

    // Each reason that can be chosen has as many as the table says.
    let reasons = browser.number("document.getElementById('by-reason').options.length - 1");
    assert!(reasons >= 1.0);
    let agree = browser.value(
        "(async () => { const by = document.getElementById('by-reason'); const rows = [...document.querySelectorAll('#rejected table')[0].tBodies[0].rows]; \
         for (const row of rows) { by.value = row.cells[0].textContent; by.form.dispatchEvent(new Event('submit', {cancelable: true})); \
         if (rejected.count() !== Number(row.cells[1].textContent.replace(/\\D/g, ''))) return row.textContent; } return true; })()",
    );
    assert_eq!(agree, json!(true));
    quiet(&browser, &page);
}

/// Mean brightness of a picture, from 0 to 255.
fn brightness(png: &[u8]) -> f64 {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let samples = &pixels[..info.buffer_size()];
    let sum: u64 = samples.chunks_exact(info.color_type.samples()).map(|it| u64::from(it[1])).sum();
    let count = samples.len() / info.color_type.samples();
    f64::from(u32::try_from(sum / u64::try_from(count).unwrap()).unwrap())
}

#[test]
#[ignore = "needs Chromium"]
fn dark_print_and_phone_are_legible() {
    let (_folder, page, _) = plan(&["span.duration_days=30"]);
    let mut browser = Chromium::start(1440, 900);
    let media = |media: &str, scheme: &str| json!({ "media": media, "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
    let mut seen = Vec::new();
    for (kind, scheme) in [("screen", "light"), ("screen", "dark"), ("print", "dark")] {
        browser.ask("Emulation.setEmulatedMedia", &media(kind, scheme));
        browser.open(&page);
        browser.value("document.getElementById('timeline').scrollIntoView()");
        browser.drawn();
        seen.push(brightness(&browser.picture()));
        // Words against their ground, WCAG 2: at least 4.5.
        let contrast = browser.number(
            "(() => { const light = c => { const [r, g, b] = c.match(/[\\d.]+/g).map(v => { v /= 255; return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }); \
             return 0.2126 * r + 0.7152 * g + 0.0722 * b; }; const paper = light(getComputedStyle(document.body).backgroundColor); let least = 99; \
             for (const it of document.querySelectorAll('p, td, th, dt, dd, a, caption, h1, h2, h3, summary, figcaption')) { \
             const ink = light(getComputedStyle(it).color); least = Math.min(least, (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05)); } return least; })()",
        );
        assert!(contrast >= 4.5, "{kind} {scheme}: {contrast}");
    }
    assert!(seen[0] > 200.0 && seen[1] < 60.0 && seen[2] > 200.0, "{seen:?}");

    browser.ask("Emulation.setEmulatedMedia", &media("screen", "light"));
    for width in [320, 390, 1440, 2560] {
        let metrics =
            json!({ "width": width, "height": 844, "deviceScaleFactor": 1, "mobile": width < 500 });
        browser.ask("Emulation.setDeviceMetricsOverride", &metrics);
        browser.open(&page);
        browser.value("timeline.choose(3, true); document.querySelectorAll('details').forEach(it => { it.open = true; })");
        browser.drawn();
        let wide = browser.number("document.documentElement.scrollWidth");
        assert!(wide <= f64::from(width), "{width}: {wide}");
    }
    let sheets = browser.ask("Page.printToPDF", &json!({}));
    assert!(sheets["data"].as_str().unwrap().len() > 10_000);
    quiet(&browser, &page);
}

#[test]
#[ignore = "needs Chromium"]
fn three_years_are_ready_within_a_second() {
    let (_folder, page, timeline) = plan(&[]);
    let size = std::fs::metadata(&page).unwrap().len();
    assert!(size <= 3_000_000, "{size}");
    assert!(timeline["rejected"].as_array().unwrap().len() > 50_000);
    let mut browser = Chromium::start(1440, 900);
    // The first page of a browser pays for its start.
    browser.open(&page);
    let mut fastest = f64::INFINITY;
    for _ in 0..3 {
        browser.open(&page);
        fastest = fastest.min(browser.number("performance.getEntriesByName('ready')[0].startTime"));
    }
    assert!(fastest < 1000.0, "{fastest} ms");
    let drawing = browser.number("(() => { const begun = performance.now(); timeline.show(0, plan.span); dispatchEvent(new Event('resize')); return performance.now() - begun; })()");
    assert!(drawing < 200.0, "{drawing} ms");
    quiet(&browser, &page);
}
