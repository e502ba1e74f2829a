//! What does a LiteBIRD instrument model (`IMo`) say about its detectors.
//!
//! Frames: `quat` is (x, y, z, w) and takes detector components to the telescope's, z the line of
//! sight; `pol_angle_rad` counts from the detector's x axis.
//!
//! Beam, band and noise are the entry's `fwhm_arcmin`, `ellipticity`, `bandcenter_ghz`, `bandwidth_ghz`,
//! `net_ukrts` and `fknee_mhz`, each where it is there and not null.
//!
//! Method: a model is JSON, compressed with gzip or not, with a list `data_files`; an entry whose `metadata` has `pixtype` (the
//! original layout) or `pixel` (the reformed one) is a detector, anything else is passed over. The
//! telescope is the entry's `telescope`, or the channel's first letter and FT: L1-040 is LFT's.
//! `releases` lists by `tag` the `uuid`s of the entries that belong together.
//!
//! Limits: `orient` and `pol` are not read, but where they alone tell a pair apart; a quaternion in
//! motion is refused (`a_faulty_entry_is_named`).

use crate::fault::Problem;
use crate::number::Number;
use crate::reading::range::Range;
use crate::reading::section::{NAME, is_name};
use crate::receiver::{BANDWIDTH, ELLIPTICITY, FREQUENCY, FWHM, KNEE, NET, Receiver};
use flate2::read::MultiGzDecoder;
use onboard_core::frame::{Detector, Telescope};
use onboard_core::rotation::{NORM_TOLERANCE, Rotation, RotationError};
use serde_json::{Map, Value};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::io::Read;

/// The most that a compressed model may hold, some hundred times LiteBIRD's.
const MOST_BYTES: u64 = 1 << 30;

/// The detectors of a model and its releases.
#[derive(Debug)]
pub(crate) struct Model {
    /// In the file's order.
    pub(crate) entries: Vec<Entry>,
    /// The entries' identifiers by the release's tag.
    pub(crate) releases: BTreeMap<String, BTreeSet<String>>,
}

/// One detector as the model has it.
#[derive(Debug)]
pub(crate) struct Entry {
    /// Its index in `data_files`.
    position: usize,
    uuid: Option<String>,
    metadata: Map<String, Value>,
}

/// One detector, checked.
#[derive(Debug)]
pub(crate) struct Mounted {
    pub(crate) name: String,
    pub(crate) rotation: Rotation<Detector, Telescope>,
    pub(crate) polarisation_angle_rad: f64,
    /// What the model says of its beam, band and noise.
    pub(crate) receiver: Receiver,
}

impl Model {
    /// Reads a model's bytes.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, Problem> {
        let bytes = unpacked(bytes)?;
        let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&bytes);
        let mut whole: Value = serde_json::from_slice(bytes)
            .map_err(|error| Problem::NotJson { message: error.to_string() })?;
        let releases = releases(&whole);
        let list = match whole.get_mut("data_files").map(Value::take) {
            Some(Value::Array(list)) => list,
            Some(other) => {
                return Err(not_legal("data_files", &shown(&other), "a list of entries"));
            }
            None => {
                let need = "the list of an instrument model's entries".to_owned();
                return Err(Problem::Missing { key: "data_files".to_owned(), need });
            }
        };
        let count = list.len();
        let entries: Vec<Entry> = list.into_iter().enumerate().filter_map(Entry::of).collect();
        if entries.is_empty() {
            let value = format!("a list of {count} entries without detectors");
            let need = "an entry whose metadata has pixtype or pixel";
            return Err(not_legal("data_files", &value, need));
        }
        Ok(Self { entries, releases })
    }
}

/// The bytes of a file that may be compressed with gzip.
fn unpacked(bytes: &[u8]) -> Result<Cow<'_, [u8]>, Problem> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut plain = Vec::new();
    let told = |message| Problem::NotJson { message };
    MultiGzDecoder::new(bytes)
        .take(MOST_BYTES + 1)
        .read_to_end(&mut plain)
        .map_err(|error| told(format!("it is compressed and cannot be unpacked: {error}")))?;
    if u64::try_from(plain.len()).is_ok_and(|length| length > MOST_BYTES) {
        return Err(told(format!("it unpacks to more than {MOST_BYTES} bytes")));
    }
    Ok(Cow::Owned(plain))
}

fn releases(whole: &Value) -> BTreeMap<String, BTreeSet<String>> {
    let list = whole.get("releases").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let one = |release: &Value| {
        let files = release.get("data_files")?.as_array()?;
        let files = files.iter().filter_map(Value::as_str).map(str::to_owned).collect();
        Some((release.get("tag")?.as_str()?.to_owned(), files))
    };
    list.iter().filter_map(one).collect()
}

impl Entry {
    /// The entry, if it is a detector.
    fn of((position, mut value): (usize, Value)) -> Option<Self> {
        let uuid = value.get("uuid").and_then(Value::as_str).map(str::to_owned);
        let Some(Value::Object(metadata)) = value.get_mut("metadata").map(Value::take) else {
            return None;
        };
        let detector = metadata.contains_key("pixtype") || metadata.contains_key("pixel");
        detector.then_some(Self { position, uuid, metadata })
    }

    fn text(&self, key: &str) -> Option<&str> {
        self.metadata.get(key).and_then(Value::as_str)
    }

    pub(crate) fn uuid(&self) -> Option<&str> {
        self.uuid.as_deref()
    }

    pub(crate) fn name(&self) -> Option<&str> {
        self.text("name")
    }

    pub(crate) fn channel(&self) -> Option<&str> {
        self.text("channel")
    }

    pub(crate) fn telescope(&self) -> Option<&str> {
        self.text("telescope").or_else(|| match self.channel()?.chars().next()? {
            'L' => Some("LFT"),
            'M' => Some("MFT"),
            'H' => Some("HFT"),
            _ => None,
        })
    }

    /// What a fault calls a key of this entry.
    pub(crate) fn key(&self, key: &str) -> String {
        match self.name().filter(|name| is_name(name)) {
            Some(name) if key != "name" => format!("{name}.{key}"),
            _ => format!("data_files.{}.metadata.{key}", self.position),
        }
    }

    /// The side of its pixel (`T`, `B`), where no angle tells the polarisation.
    pub(crate) fn side_without_angle(&self) -> Option<&str> {
        let angle = self.metadata.get("pol_angle_rad").is_some_and(|value| !value.is_null());
        self.text("pol").filter(|_| !angle)
    }

    /// The detector, checked.
    pub(crate) fn mounted(&self) -> Result<Mounted, Problem> {
        let name = match self.metadata.get("name") {
            Some(Value::String(name)) if is_name(name) => name.clone(),
            Some(other) => return Err(not_legal(&self.key("name"), &shown(other), NAME)),
            None => return Err(Problem::Missing { key: self.key("name"), need: NAME.to_owned() }),
        };
        let (rotation, polarisation_angle_rad) = (self.rotation()?, self.polarisation_angle_rad()?);
        Ok(Mounted { name, rotation, polarisation_angle_rad, receiver: self.receiver()? })
    }

    /// Beam, band and noise.
    fn receiver(&self) -> Result<Receiver, Problem> {
        let receiver = Receiver {
            fwhm_arcmin: self.number("fwhm_arcmin", &FWHM)?,
            frequency_ghz: self.number("bandcenter_ghz", &FREQUENCY)?,
            bandwidth_ghz: self.number("bandwidth_ghz", &BANDWIDTH)?,
            net_uk_rts: self.number("net_ukrts", &NET)?,
            ellipticity: self.number("ellipticity", &ELLIPTICITY)?,
            knee_mhz: self.number("fknee_mhz", &KNEE)?,
            time_constant_ms: None,
        };
        if let (Some(width), Some(centre)) = (&receiver.bandwidth_ghz, &receiver.frequency_ghz)
            && width.times(1, 1) >= centre.times(2, 1)
        {
            return Err(Problem::OutOfRange {
                key: self.key("bandwidth_ghz"),
                value: width.text().to_owned(),
                need: format!("less than twice the frequency, {} GHz,", centre.text()),
                hint: "",
            });
        }
        Ok(receiver)
    }

    /// A number that may be absent or null.
    fn number(&self, key: &str, range: &Range) -> Result<Option<Number>, Problem> {
        match self.metadata.get(key) {
            None | Some(Value::Null) => Ok(None),
            Some(value) => {
                let number = match value {
                    Value::Number(number) => Number::parse(&number.to_string()).ok(),
                    _ => None,
                };
                let key = self.key(key);
                match number {
                    Some(number) if range.holds(number.exact()) => Ok(Some(number)),
                    Some(_) => Err(Problem::OutOfRange {
                        key,
                        value: shown(value),
                        need: range.to_string(),
                        hint: "",
                    }),
                    None => Err(not_legal(&key, &shown(value), &range.to_string())),
                }
            }
        }
    }

    fn rotation(&self) -> Result<Rotation<Detector, Telescope>, Problem> {
        let key = self.key("quat");
        let need = "a list of 4 numbers x, y, z, w";
        let value = match self.metadata.get("quat") {
            Some(Value::Null) | None => {
                return Err(Problem::Missing { key, need: need.to_owned() });
            }
            Some(value) => value,
        };
        let numbers: Option<Vec<f64>> =
            value.as_array().and_then(|list| list.iter().map(Value::as_f64).collect());
        let xyzw: [f64; 4] = numbers
            .and_then(|numbers| numbers.try_into().ok())
            .ok_or_else(|| not_legal(&key, &shown(value), need))?;
        Rotation::from_xyzw(xyzw).map_err(|error| {
            let norm = match error {
                RotationError::NotUnit(norm) => norm,
                RotationError::NotFinite => f64::INFINITY,
            };
            Problem::OutOfRange {
                key: format!("the norm of {key}"),
                value: norm.to_string(),
                need: format!("a unit quaternion x, y, z, w to {NORM_TOLERANCE:e}"),
                hint: "",
            }
        })
    }

    fn polarisation_angle_rad(&self) -> Result<f64, Problem> {
        let key = self.key("pol_angle_rad");
        let need = "an angle from -2 pi to 2 pi rad";
        match self.metadata.get("pol_angle_rad") {
            None | Some(Value::Null) => Ok(0.0),
            Some(value) => match value.as_f64() {
                Some(angle) if angle.abs() <= TAU => Ok(angle),
                Some(angle) => {
                    let (value, need) = (angle.to_string(), need.to_owned());
                    Err(Problem::OutOfRange { key, value, need, hint: "" })
                }
                None => Err(not_legal(&key, &shown(value), need)),
            },
        }
    }
}

fn not_legal(key: &str, value: &str, need: &str) -> Problem {
    Problem::NotLegal { key: key.to_owned(), value: value.to_owned(), need: need.to_owned() }
}

/// A value as JSON, cut where it is long.
fn shown(value: &Value) -> String {
    let text = value.to_string();
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use onboard_core::direction::Direction;
    use proptest::prelude::*;
    use std::io::Write;

    fn refused(text: &str) -> String {
        Model::parse(text.as_bytes()).unwrap_err().to_string()
    }

    /// The only entry, with this metadata.
    fn entry(metadata: &str) -> Entry {
        let text = format!(r#"{{"data_files": [{{}}, {{"metadata": {metadata}}}]}}"#);
        Model::parse(text.as_bytes()).unwrap().entries.remove(0)
    }

    fn fault(metadata: &str) -> String {
        entry(metadata).mounted().unwrap_err().to_string()
    }

    #[test]
    fn what_is_no_model_is_refused() {
        assert_eq!(refused("{"), "not JSON: EOF while parsing an object at line 1 column 1");
        assert_eq!(refused("\u{1f}"), "not JSON: expected value at line 1 column 1");
        let compressed = Model::parse(&[0x1f, 0x8b, 8]).unwrap_err().to_string();
        let told = "not JSON: it is compressed and cannot be unpacked: ";
        assert!(compressed.starts_with(told), "{compressed}");
        for text in ["{}", "[]", "3"] {
            assert_eq!(
                refused(text),
                "data_files is missing: the list of an instrument model's entries is needed"
            );
        }
        assert_eq!(
            refused(r#"{"data_files": {"a": 1}}"#),
            "data_files = {\"a\":1} is not legal: a list of entries is needed"
        );
        assert_eq!(
            refused(r#"{"data_files": [3, {"metadata": {"channel": "H1-119"}}]}"#),
            "data_files = a list of 2 entries without detectors is not legal: an entry whose metadata \
             has pixtype or pixel is needed"
        );
    }

    #[test]
    fn a_faulty_entry_is_named() {
        let name = "data_files.1.metadata.name";
        assert!(fault(r#"{"pixel": 1}"#).starts_with(&format!("{name} is missing: a name of 1")));
        assert!(
            fault(r#"{"pixel": 1, "name": "a,b"}"#).starts_with(&format!("{name} = \"a,b\" is"))
        );
        let quat = |quat: &str| fault(&format!(r#"{{"pixel": 1, "name": "d", "quat": {quat}}}"#));
        let need = "a list of 4 numbers x, y, z, w is needed";
        assert_eq!(
            fault(r#"{"pixtype": "HP1", "name": "d"}"#),
            format!("d.quat is missing: {need}")
        );
        assert_eq!(quat("null"), format!("d.quat is missing: {need}"));
        for bad in ["[0,0,1]", "[0,0,0,0,1]", "[0,0,\"nan\",1]", "{\"quats\":[[0,0,0,1]]}", "\"x\""]
        {
            assert_eq!(quat(bad), format!("d.quat = {bad} is not legal: {need}"));
        }
        assert_eq!(
            quat("[0, 0, 0, 1.00001]"),
            "the norm of d.quat = 1.00001 is out of range: a unit quaternion x, y, z, w to 1e-6 is \
             needed"
        );
        assert!(quat("[1e300, 0, 0, 1e300]").starts_with("the norm of d.quat = inf is"));
        let angle = |angle: &str| {
            let quat = "[0, 0, 0, 1]";
            fault(&format!(
                r#"{{"pixel": 1, "name": "d", "quat": {quat}, "pol_angle_rad": {angle}}}"#
            ))
        };
        let need = "an angle from -2 pi to 2 pi rad is needed";
        assert_eq!(angle("-7.5"), format!("d.pol_angle_rad = -7.5 is out of range: {need}"));
        assert_eq!(angle("\"Q\""), format!("d.pol_angle_rad = \"Q\" is not legal: {need}"));
    }

    #[test]
    fn a_compressed_model_is_unpacked() {
        let text =
            r#"{"data_files": [{"metadata": {"pixel": 1, "name": "d", "channel": "L1-040"}}]}"#;
        let mut packed = Vec::new();
        let mut packing = flate2::write::GzEncoder::new(&mut packed, flate2::Compression::fast());
        packing.write_all(text.as_bytes()).unwrap();
        packing.finish().unwrap();
        assert_eq!(Model::parse(&packed).unwrap().entries[0].channel(), Some("L1-040"));
        packed.truncate(packed.len() - 9);
        assert!(Model::parse(&packed).is_err());
    }

    #[test]
    fn beam_band_and_noise_are_read_and_checked() {
        let with = |values: &str| {
            entry(&format!(r#"{{"pixel": 1, "name": "d", "quat": [0, 0, 0, 1], {values}}}"#))
        };
        let all = r#""fwhm_arcmin": 17.9, "ellipticity": 1.0, "bandcenter_ghz": 402.0,
            "bandwidth_ghz": 92.0, "net_ukrts": 385.69, "fknee_mhz": 2e1"#;
        let found = with(all).mounted().unwrap().receiver;
        let texts = [
            found.fwhm_arcmin,
            found.ellipticity,
            found.frequency_ghz,
            found.bandwidth_ghz,
            found.net_uk_rts,
            found.knee_mhz,
        ]
        .map(|it| it.unwrap().text().to_owned());
        assert_eq!(texts, ["17.9", "1.0", "402.0", "92.0", "385.69", "20.0"]);
        let none = with(r#""net_ukrts": null"#).mounted().unwrap().receiver;
        assert_eq!(none, Receiver::default());
        let fault = |values: &str| with(values).mounted().unwrap_err().to_string();
        assert_eq!(
            fault(r#""net_ukrts": -1.0"#),
            "d.net_ukrts = -1.0 is out of range: a noise above 0 and at most 1e12 uK sqrt(s) is needed"
        );
        assert!(fault(r#""fknee_mhz": "20""#).starts_with("d.fknee_mhz = \"20\" is not legal: "));
        assert_eq!(
            fault(r#""bandcenter_ghz": 40, "bandwidth_ghz": 80"#),
            "d.bandwidth_ghz = 80 is out of range: less than twice the frequency, 40 GHz, is needed"
        );
    }

    #[test]
    fn a_rounded_quaternion_is_made_a_unit_again() {
        let found = entry(r#"{"pixel": 1, "name": "d", "quat": [0.6, 0, 0, 0.8000009]}"#);
        let [x, y, z, w] = found.mounted().unwrap().rotation.to_xyzw();
        assert!((x * x + y * y + z * z + w * w - 1.0).abs() < 1e-15);
        let [.., z] = found.mounted().unwrap().rotation.apply(Direction::Z).xyz();
        assert!((z - 0.28).abs() < 2e-6);
    }

    #[test]
    fn the_telescope_is_told_or_the_channels_first_letter() {
        let of = |metadata: &str| entry(metadata).telescope().map(str::to_owned);
        assert_eq!(of(r#"{"pixel": 1, "channel": "M2-166"}"#).as_deref(), Some("MFT"));
        assert_eq!(
            of(r#"{"pixel": 1, "channel": "M2-166", "telescope": "MHFT"}"#).as_deref(),
            Some("MHFT")
        );
        assert_eq!(of(r#"{"pixel": 1, "channel": "60 GHz"}"#), None);
        assert_eq!(of(r#"{"pixel": 1}"#), None);
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
            let _ = Model::parse(&bytes);
        }

        #[test]
        fn no_metadata_panics(
            name in "\"[a\u{e9},]{0,3}\"|null|3",
            quat in "\\[(-?[0-9](e[0-9]{1,3})?, ){0,4}[0-9]\\]|null|\"\u{e9}{70}\"",
            angle in "-?[0-9]{1,2}|null|\\{\\}",
        ) {
            let text = format!(
                r#"{{"data_files": [{{"metadata":
                {{"pixel": 1, "name": {name}, "quat": {quat}, "pol_angle_rad": {angle}}}}}]}}"#
            );
            if let Ok(model) = Model::parse(text.as_bytes())
                && let Ok(mounted) = model.entries[0].mounted()
            {
                prop_assert!(mounted.rotation.to_xyzw().iter().all(|it| it.is_finite()));
            }
        }
    }
}
