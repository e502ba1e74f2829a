//! The target's words against the host's, as the host's run makes them.

use crate::input::{Input, small};
use libtest_mimic::Failed;
use std::collections::BTreeMap;
use vectors::sink::Sink;

/// What was compared and found equal.
#[derive(Debug, Clone, Copy)]
pub struct Same {
    /// Instants, transits, damaged tables.
    pub items: u64,
    /// Words.
    pub words: u64,
}

struct Comparison<'t> {
    names: &'t [String],
    target: &'t [[u8; 8]],
    block: usize,
    item: i64,
    done: Same,
    difference: Option<String>,
}

impl Sink for Comparison<'_> {
    fn block(&mut self, index: u32) {
        self.block = index as usize;
        self.item = 0;
    }

    fn item(&mut self, item: i64) {
        self.item = item;
        self.done.items += 1;
    }

    fn word(&mut self, field: &'static str, bits: u64) {
        let word = self.done.words;
        self.done.words += 1;
        if self.difference.is_some() {
            return;
        }
        let theirs = self.target.get(word as usize).map(|bytes| u64::from_le_bytes(*bytes));
        if theirs != Some(bits) {
            let theirs = theirs.map_or("nothing more".to_owned(), told);
            self.difference = Some(format!(
                "word {word} ({}, item {}, {field}): the host has {}, the target {theirs}",
                self.names[self.block],
                self.item,
                told(bits)
            ));
        }
    }
}

/// A word as bits and as a number.
fn told(bits: u64) -> String {
    format!("{bits:#018x} = {:e}", f64::from_bits(bits))
}

/// Runs the input on the host and holds the target's output against it.
///
/// # Errors
/// The first difference: block, item, field, both words.
pub fn compare(input: &Input, output: &[u8]) -> Result<Same, Failed> {
    let (target, rest) = output.as_chunks::<8>();
    let mut comparison = Comparison {
        names: &input.names,
        target,
        block: 0,
        item: 0,
        done: Same { items: 0, words: 0 },
        difference: None,
    };
    let mut scratch = vec![0; 256 << 10];
    vectors::run(&input.bytes, &mut scratch, &|| 0, &mut comparison)
        .map_err(|error| format!("on the host, in {}: {error:?}", input.names[comparison.block]))?;
    if let Some(difference) = comparison.difference {
        return Err(difference.into());
    }
    let (ours, theirs) = (comparison.done.words as usize, target.len());
    if ours != theirs || !rest.is_empty() {
        return Err(format!("the host has {ours} words, the target {theirs}").into());
    }
    Ok(comparison.done)
}

struct Words(Vec<u8>);

impl Sink for Words {
    fn block(&mut self, _: u32) {}

    fn item(&mut self, _: i64) {}

    fn word(&mut self, _: &'static str, bits: u64) {
        self.0.extend(bits.to_le_bytes());
    }
}

struct Fields {
    words: BTreeMap<&'static str, u64>,
    block: usize,
}

impl Sink for Fields {
    fn block(&mut self, index: u32) {
        self.block = index as usize;
    }

    fn item(&mut self, _: i64) {}

    fn word(&mut self, field: &'static str, _: u64) {
        *self.words.entry(field).or_default() += 1;
    }
}

/// How many words of each field the host makes of an input.
///
/// # Errors
/// Where the input is malformed.
pub fn fields(input: &Input) -> Result<BTreeMap<&'static str, u64>, Failed> {
    let mut fields = Fields { words: BTreeMap::new(), block: 0 };
    match vectors::run(&input.bytes, &mut vec![0; 256 << 10], &|| 0, &mut fields) {
        Ok(()) => Ok(fields.words),
        Err(error) => Err(format!(
            "the host refuses '{}': {error:?}, after {:?}",
            input.names[fields.block], fields.words
        )
        .into()),
    }
}

struct Letters<'f> {
    fields: &'f [&'static str],
    letters: Vec<u8>,
}

impl Sink for Letters<'_> {
    fn block(&mut self, _: u32) {}

    fn item(&mut self, _: i64) {}

    fn word(&mut self, field: &'static str, bits: u64) {
        if self.fields.contains(&field) {
            self.letters.extend(bits.to_le_bytes());
        }
    }
}

/// What the host writes as text in these fields.
///
/// # Errors
/// Where the input is malformed.
pub fn texts(input: &Input, fields: &[&'static str]) -> Result<String, Failed> {
    let mut sink = Letters { fields, letters: Vec::new() };
    vectors::run(&input.bytes, &mut vec![0; 256 << 10], &|| 0, &mut sink)
        .map_err(|error| format!("the host refuses the vector file: {error:?}"))?;
    Ok(String::from_utf8_lossy(&sink.letters).into_owned())
}

/// The words that the host makes of an input.
///
/// # Errors
/// Where the input is malformed.
fn words(input: &Input) -> Result<Vec<u8>, Failed> {
    let mut words = Words(Vec::new());
    match vectors::run(&input.bytes, &mut vec![0; 256 << 10], &|| 0, &mut words) {
        Ok(()) => Ok(words.0),
        Err(error) => Err(format!("after {} words: {error:?}", words.0.len() / 8).into()),
    }
}

/// The comparison passes on the host's own words, and names one flipped bit and a missing word.
pub fn one_flipped_bit_is_named() -> Result<(), Failed> {
    let input = small();
    let good = words(&input)?;
    let same = compare(&input, &good)?;
    assert_eq!(same.words as usize * 8, good.len());

    // The first instant's zeta: after a quaternion, a quaternion, a direction and psi.
    let mut bad = good.clone();
    bad[12 * 8] ^= 1;
    let said = compare(&input, &bad).unwrap_err().message().unwrap_or_default().to_owned();
    assert!(said.starts_with("word 12 (litebird, item ") && said.contains(", zeta)"), "{said}");

    let cut = compare(&input, &good[..good.len() - 8]).unwrap_err();
    assert!(cut.message().is_some_and(|said| said.contains("nothing more")), "{cut:?}");
    let mut long = good;
    long.extend([0; 8]);
    assert!(compare(&input, &long).is_err());
    Ok(())
}
