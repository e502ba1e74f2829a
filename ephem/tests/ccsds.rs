//! OEM and AEM through one reader: KVN and XML in the same shape, values in letters of any case,
//! epochs with any number of decimals, and refusals that name line, key and value.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use ephem::ccsds::{Axes, CcsdsError, Column, Document, Holder, MessageKind, Notation, epoch};
use ephem::kernel::{EARTH, Kernel};
use ephem::time::{Scale, parse_time};
use ephem::trajectory::Trajectory;
use nalgebra::Vector3;

const OEM: &str = "\
CCSDS_OEM_VERS = 3.0
CREATION_DATE = 2026-11-30T02:35:24.8941506844
ORIGINATOR = T
META_START
OBJECT_NAME = X
OBJECT_ID = 2032-001A
CENTER_NAME = EARTH
REF_FRAME = EME2000
TIME_SYSTEM = TDB
START_TIME = 2032-04-01T00:01:09.1856655959
STOP_TIME = 2032-04-01T06:01:09.1856659309
INTERPOLATION = LINEAR
META_STOP
2032-04-01T00:01:09.1856655959 -1478488.021257  -276779.070602  -119726.108833 0.066294134 -0.274833871 -0.118090223
2032-04-01T03:01:09.1856657673 -1477767.992533  -279744.879855  -121000.548741 0.067042823 -0.274389154 -0.117916932
2032-04-01T06:01:09.1856659309 -1477039.933213  -282705.857137  -122273.109661 0.067781254 -0.273939105 -0.117742280
";

const OEM_XML: &str = "\
<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<oem id=\"CCSDS_OEM_VERS\" version=\"3.0\"><header><CREATION_DATE>2026-11-30T02:35:24</CREATION_DATE>
<ORIGINATOR>T</ORIGINATOR></header><body>
<segment>
<metadata><COMMENT>one</COMMENT><COMMENT>two</COMMENT><OBJECT_NAME>X</OBJECT_NAME>
<OBJECT_ID>2032-001A</OBJECT_ID><CENTER_NAME>earth</CENTER_NAME><REF_FRAME>eme2000</REF_FRAME>
<TIME_SYSTEM>tdb</TIME_SYSTEM><START_TIME>2032-092T00:01:09.1856655959</START_TIME>
<STOP_TIME>2032-092T06:01:09.1856659309</STOP_TIME><INTERPOLATION>linear</INTERPOLATION>
</metadata>
<data><COMMENT>three</COMMENT>
<stateVector><EPOCH>2032-092T00:01:09.1856655959</EPOCH><X units=\"km\">-1478488.021257</X>
<Y>-276779.070602</Y><Z>-119726.108833</Z><X_DOT units=\"km/s\">0.066294134</X_DOT>
<Y_DOT>-0.274833871</Y_DOT><Z_DOT>-0.118090223</Z_DOT></stateVector>
<stateVector><EPOCH>2032-092T03:01:09.1856657673</EPOCH><X>-1477767.992533</X>
<Y>-279744.879855</Y><Z>-121000.548741</Z><X_DOT>0.067042823</X_DOT><Y_DOT>-0.274389154</Y_DOT>
<Z_DOT>-0.117916932</Z_DOT><X_DDOT>0</X_DDOT><Y_DDOT>0</Y_DDOT><Z_DDOT>0</Z_DDOT></stateVector>
<stateVector><EPOCH>2032-092T06:01:09.1856659309</EPOCH><X>-1477039.933213</X>
<Y>-282705.857137</Y><Z>-122273.109661</Z><X_DOT>0.067781254</X_DOT><Y_DOT>-0.273939105</Y_DOT>
<Z_DOT>-0.117742280</Z_DOT></stateVector>
<covarianceMatrix><EPOCH>2032-092T00:01:09</EPOCH><CX_X>1</CX_X></covarianceMatrix>
</data></segment></body></oem>
";

fn from_earth(text: &str, at: &str) -> Vector3<f64> {
    let (kernel, at) = (Kernel::embedded(), parse_time(at).unwrap());
    let state = Trajectory::from_oem("a.oem", text).unwrap().state(&kernel, at).unwrap();
    state.position_km - kernel.state(EARTH, at).unwrap().position_km
}

#[test]
fn ten_decimals_are_rounded_to_the_ns() {
    let (start, end) = Trajectory::from_oem("a.oem", OEM).unwrap().coverage().unwrap();
    assert_eq!(start, parse_time("2032-04-01T00:01:09.185665596 TDB").unwrap());
    assert_eq!(end, parse_time("2032-04-01T06:01:09.185665931 TDB").unwrap());
    let seen = from_earth(OEM, "2032-04-01T03:01:09.185665767 TDB");
    let row = Vector3::new(-1_477_767.992_533, -279_744.879_855, -121_000.548_741);
    assert!((seen - row).norm() < 1e-6, "{seen}");
}

#[test]
fn xml_says_the_same_as_kvn() {
    let kvn = Trajectory::from_oem("a.oem", OEM).unwrap();
    for xml in [
        OEM_XML.to_owned(),
        format!("\u{feff}{}", OEM_XML.replace('\n', "\r\n")),
        OEM_XML.replace("<oem ", "<ndm><oem ").replace("</oem>", "</oem></ndm>"),
    ] {
        let xml = Trajectory::from_oem("a.xml", &xml).unwrap();
        assert_eq!(xml.coverage(), kvn.coverage());
        let (kernel, at) = (Kernel::embedded(), parse_time("2032-04-01T05:00:00.123 TDB").unwrap());
        assert_eq!(xml.state(&kernel, at).unwrap(), kvn.state(&kernel, at).unwrap());
    }
}

#[test]
fn values_may_be_in_small_letters() {
    let small = OEM
        .replace("= EARTH", "= earth")
        .replace("= EME2000", "= gcrf")
        .replace("= TDB", "= tdb")
        .replace("= LINEAR", "= linear")
        .replace("2032-04-01T", "2032-092T");
    let at = "2032-04-01T05:00:00 TDB";
    assert_eq!(from_earth(&small, at), from_earth(OEM, at));
    for (name, axes) in [("icrf", Axes::Icrf), ("j2000", Axes::Icrf), ("ICRF3", Axes::Icrf)] {
        assert_eq!(Axes::from_name(name), Some(axes));
        let other = OEM.replace("= EME2000", &format!("= {name}"));
        assert_eq!(from_earth(&other, at), from_earth(OEM, at));
    }
}

#[test]
fn states_in_the_ecliptic_are_turned_to_icrf() {
    let at = "2032-04-01T03:01:09.185665767 TDB";
    let turned = from_earth(&OEM.replace("EME2000", "ECLIPJ2000"), at);
    let seen = from_earth(OEM, at);
    // SPICE's ECLIPJ2000 to J2000: a turn by +84381.448 arcsec about x.
    let (sin, cos) = (84_381.448_f64 / 3600.0).to_radians().sin_cos();
    let expected = Vector3::new(seen.x, cos * seen.y - sin * seen.z, cos * seen.z + sin * seen.y);
    assert!((turned - expected).norm() < 1e-6, "{turned} {expected}");
}

#[test]
fn xml_is_refused_with_line_and_value() {
    let said = |from: &str, to: &str| {
        assert!(OEM_XML.contains(from), "{from}");
        let text = OEM_XML.replacen(from, to, 1);
        Trajectory::from_oem("a.xml", &text).unwrap_err().to_string()
    };
    for (from, to, expected) in [
        (
            "version=\"3.0\"><header>",
            "version=\"9\"><header>",
            "line 2: version is '9'; legal is 1.0, 2.0, 3.0",
        ),
        ("eme2000", "TEME", "line 6: REF_FRAME is 'TEME'; legal is ICRF, GCRF, EME2000, J2000"),
        ("tdb", "gps", "line 7: TIME_SYSTEM is 'gps'; legal is UTC, TDB, TAI, TT"),
        (
            "<REF_FRAME>eme2000</REF_FRAME>",
            "",
            "line 5: the metadata that begins here has no REF_FRAME",
        ),
        (
            "<OBJECT_NAME>X</OBJECT_NAME>",
            "<NAME>X</NAME>",
            "line 5: unknown key 'NAME'; legal are CENTER_NAME",
        ),
        (
            "<OBJECT_ID>2032-001A</OBJECT_ID>",
            "<OBJECT_NAME>Y</OBJECT_NAME>",
            "line 6: OBJECT_NAME is 'Y'; legal is one value, and line 5 gives it already",
        ),
        ("<Y>-276779.070602</Y>", "", "line 11: the stateVector that begins here has no Y"),
        ("units=\"km\"", "units=\"m\"", "line 11: the unit of X is 'm'; legal is km"),
        ("-279744.879855", "nan", "line 14: '2032-092T03:01:09.1856657673 -1477767.992533 nan"),
        ("-279744.879855", "east", "is not a state: epoch, x y z in km"),
        (
            "2032-092T03:01:09.1856657673",
            "2032-092T03:01",
            "line 14: epoch: time '2032-092T03:01' has no seconds",
        ),
        (
            "2032-092T03:01:09.1856657673",
            "2032-091T03:01:09",
            "line 14: the epoch '2032-091T03:01:09' is not later",
        ),
        ("<metadata>", "<meta>", "not readable as XML"),
        ("</oem>", "", "not readable as XML"),
        ("<?xml", "<!DOCTYPE oem [<!ENTITY a 'b'>]><?xml", "not readable as XML"),
    ] {
        let said = said(from, to);
        assert!(said.starts_with("the trajectory 'a.xml', ") && said.contains(expected), "{said}");
    }
    let none = "<oem id=\"CCSDS_OEM_VERS\" version=\"2.0\"><body/></oem>";
    let said = Trajectory::from_oem("a.xml", none).unwrap_err().to_string();
    assert_eq!(said, "the trajectory 'a.xml', the file holds no segment");
    let said = Trajectory::from_oem("a.xml", "<aem version=\"2.0\"/>").unwrap_err().to_string();
    assert!(said.contains("line 1: 'aem' is not an oem"), "{said}");
}

const AEM: &str = "\
CCSDS_AEM_VERS = 2.0
COMMENT made for a test
META_START
COMMENT twice
COMMENT is legal
REF_FRAME_A = gcrf
TIME_SYSTEM = utc
META_STOP
DATA_START
2032-04-01T00:00:00.9999999999Z 0 0 0 1

2032-092T00:00:02 0 0 0 1
DATA_STOP
META_START
TIME_SYSTEM = TAI
META_STOP
DATA_START
DATA_STOP
";

#[test]
fn segments_come_with_their_lines() {
    let document = Document::parse(AEM).unwrap();
    assert_eq!(document.notation(), Notation::Kvn);
    let segments: Vec<_> =
        document.segments(&MessageKind::AEM).unwrap().collect::<Result<_, _>>().unwrap();
    let [first, second] = &segments[..] else { panic!("{segments:?}") };
    assert_eq!((first.line, first.records.len()), (3, 2));
    assert_eq!((second.line, second.records.len()), (14, 0));
    assert_eq!(first.meta.find("TIME_SYSTEM").unwrap().line, 7);
    assert_eq!(
        (first.meta.time_system(), second.meta.time_system()),
        (Ok(Scale::Utc), Ok(Scale::Tai))
    );
    let holder = Holder::EndedBy("META_STOP");
    let missing = CcsdsError::Missing { line: 16, holder, key: "REF_FRAME_A" };
    assert_eq!(second.meta.need("REF_FRAME_A"), Err(missing));
    let record = &first.records[0];
    assert_eq!(record.line, 10);
    let columns = ["EPOCH", "Q1", "Q2", "Q3", "QC"].map(Column::of);
    assert_eq!(record.fields(&columns, &[3]), Ok(None));
    let fields = record.fields(&columns, &[0, 3]).unwrap().unwrap();
    let at = epoch(record.line, "epoch", fields[0], Scale::Utc).unwrap();
    assert_eq!(at, parse_time("2032-04-01T00:00:01Z").unwrap());
    // Zulu is UTC's alone.
    let said = epoch(10, "epoch", fields[0], Scale::Tai).unwrap_err().to_string();
    assert!(said.starts_with("line 10: epoch: time '2032-04-01T00:00:00.9999999999Z'"), "{said}");
}

#[test]
fn the_first_error_ends_the_segments() {
    let text = AEM.replacen("\nDATA_STOP", "", 1).replace("TIME_SYSTEM = TAI", "TIME = TAI");
    let document = Document::parse(&text).unwrap();
    let mut segments = document.segments(&MessageKind::AEM).unwrap();
    // Without its end, the data runs on to the end of the next.
    assert_eq!(segments.next().unwrap().unwrap().records.len(), 6);
    assert!(segments.next().is_none());
    let text = AEM.replace("TIME_SYSTEM = utc", "TIME = UTC");
    let document = Document::parse(&text).unwrap();
    let mut segments = document.segments(&MessageKind::AEM).unwrap();
    let said = segments.next().unwrap().unwrap_err().to_string();
    assert!(said.starts_with("line 7: unknown key 'TIME'; legal are ANGVEL_FRAME, "), "{said}");
    assert!(segments.next().is_none());
}

#[test]
fn cut_messages_are_read_or_refused() {
    for (text, kind) in
        [(OEM, &MessageKind::OEM), (OEM_XML, &MessageKind::OEM), (AEM, &MessageKind::AEM)]
    {
        for length in 0..text.len() {
            if let Ok(document) = Document::parse(&text[..length])
                && let Ok(segments) = document.segments(kind)
            {
                assert!(segments.count() <= 2);
            }
        }
    }
}
