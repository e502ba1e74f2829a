//! HEALPix maps in FITS: files that healpy and astropy wrote (`data/healpix/make.py`), files of our
//! own, and files that are wrong.
#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use formats::WriteError;
use formats::fits::{
    Card, Column, ColumnChoice, FitsError, Frames, Map, MapFrame, MapHeader, Polcconv, UNSEEN,
    Values, read_map, read_map_from, read_stokes, read_stokes_from, write_maps, write_primary,
    write_table,
};
use ground_tools::failure::Failure;
use ground_tools::output::Sink;
use planner::healpix::{Nside, Ordering};
use proptest::prelude::*;
use std::path::PathBuf;

const ALL: Frames<'static> = Frames {
    accepted: &[MapFrame::Ecliptic, MapFrame::Galactic, MapFrame::Equatorial],
    unsaid: None,
};

fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/healpix").join(name)
}

fn header(nside: u32, ordering: Ordering) -> MapHeader {
    MapHeader {
        nside: Nside::new(nside).unwrap(),
        ordering,
        frame: MapFrame::Ecliptic,
        name: "SURVEY".to_owned(),
        polcconv: None,
        cards: vec![Card::text("MISSION", "a mission", "")],
    }
}

fn ours(nside: u32, ordering: Ordering) -> Vec<u8> {
    let hits = |pixel: u32| i64::from(pixel) << 33;
    let sigma = |pixel: u32| if pixel == 3 { f64::NAN } else { f64::from(pixel).sqrt() };
    let single = |pixel: u32| if pixel == 4 { f32::NAN } else { 0.5 };
    let columns = [
        Column { name: "HITS", unit: "", values: Values::Integer(&hits) },
        Column { name: "SIGMA", unit: "deg", values: Values::Double(&sigma) },
        Column { name: "HALF", unit: "K", values: Values::Single(&single) },
    ];
    let mut out = Vec::new();
    write_maps(&mut out, &header(nside, ordering), &columns).unwrap();
    out
}

fn column(bytes: &[u8], name: &str) -> Result<Map, FitsError> {
    read_map_from(&mut &bytes[..], ColumnChoice::Name(name), ALL)
}

/// The file with `from` replaced by `to` of the same length, in the first place it is found.
fn altered(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let place = bytes.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
    let mut bytes = bytes.to_vec();
    bytes[place..place + to.len()].copy_from_slice(to.as_bytes());
    bytes
}

fn refusal(bytes: &[u8]) -> String {
    column(bytes, "SIGMA").unwrap_err().to_string()
}

#[expect(clippy::cast_precision_loss, reason = "pixel numbers are small")]
fn expect(values: &[f64], unseen: &[usize], value: impl Fn(f64) -> f64) {
    for (pixel, &found) in values.iter().enumerate() {
        if unseen.contains(&pixel) {
            assert!(found.is_nan(), "pixel {pixel}: {found}");
        } else {
            assert_eq!(found.to_bits(), value(pixel as f64).to_bits(), "pixel {pixel}: {found}");
        }
    }
}

#[test]
fn maps_that_healpy_wrote_are_read() {
    let map = read_stokes(&data("stokes_ring_f32.fits"), ALL).unwrap();
    assert_eq!((map.nside.get(), map.ordering, map.frame), (4, Ordering::Ring, MapFrame::Galactic));
    expect(&map.i, &[7], |p| p + 0.25);
    expect(&map.q, &[], |p| p * 2.0);
    expect(&map.u, &[], |p| 0.0 - p / 4.0);

    let named = data("named_nested_f64.fits");
    let map = read_map(&named, ColumnChoice::Name("sigma"), ALL).unwrap();
    assert_eq!((map.ordering, map.frame), (Ordering::Nested, MapFrame::Ecliptic));
    assert_eq!((map.name.as_str(), map.unit.as_str()), ("SIGMA", "K"));
    expect(&map.values, &[], |p| p);
    let map = read_map(&named, ColumnChoice::Index(0), ALL).unwrap();
    expect(&map.values, &[], |p| p / 3.0);

    let unsaid = Frames { unsaid: Some(MapFrame::Galactic), ..ALL };
    let map = read_map(&data("packed_ring_i16.fits"), ColumnChoice::Index(0), unsaid).unwrap();
    assert_eq!((map.nside.get(), map.frame), (16, MapFrame::Galactic));
    expect(&map.values, &[], |p| p - 1000.0);
}

#[test]
fn pixels_that_are_listed_are_found_and_the_others_unobserved() {
    let map = read_map(&data("partial.fits"), ColumnChoice::Index(0), ALL).unwrap();
    let expected: Vec<usize> = (150..170).collect();
    let seen: Vec<usize> = (0..192).filter(|&pixel| !map.values[pixel].is_nan()).collect();
    assert_eq!((map.nside.get(), seen), (4, expected));
    assert!(map.values[150..170].iter().all(|it| (it - 1.5).abs() < 1e-12));
}

#[test]
fn a_map_compressed_by_gzip_is_the_map() {
    let plain = read_stokes(&data("stokes_ring_f32.fits"), ALL).unwrap();
    let packed = read_stokes(&data("stokes_ring_f32.fits.gz"), ALL).unwrap();
    assert_eq!((plain.q, plain.u), (packed.q, packed.u));
}

#[test]
fn pixels_counted_from_one_are_a_whole_sky() {
    let map = read_stokes(&data("one_based_firstpix.fits"), ALL).unwrap();
    assert_eq!((map.nside.get(), map.i.len()), (16, 3072));
    assert!(map.i.iter().chain(&map.q).chain(&map.u).all(|it| it.is_finite()));
}

#[test]
fn a_file_may_say_what_stands_for_no_value() {
    let map = read_stokes(&data("bad_data_keyword.fits"), ALL).unwrap();
    let missing = map.i.iter().filter(|it| it.is_nan()).count();
    assert!(missing > 0 && missing < map.i.len(), "{missing}");
    assert!(map.i.iter().chain(&map.q).chain(&map.u).all(|it| it.is_nan() || it.abs() < 900.0));
}

#[test]
fn without_its_keyword_the_resolution_is_that_of_the_values() {
    let bytes = altered(&ours(4, Ordering::Ring), "NSIDE   =", "NOSIDE  =");
    assert_eq!(column(&bytes, "SIGMA").unwrap().nside.get(), 4);
}

#[test]
fn scaled_integers_behind_another_extension_are_read() {
    let file = data("scaled_second.fits");
    let map = read_map(&file, ColumnChoice::Name("COUNT"), ALL).unwrap();
    assert_eq!((map.nside.get(), map.frame), (2, MapFrame::Ecliptic));
    expect(&map.values, &[5], |p| p + 2_147_483_648.0);
    let map = read_map(&file, ColumnChoice::Name("HALF"), ALL).unwrap();
    expect(&map.values, &[], |p| p / 2.0);
    let failure = read_map(&file, ColumnChoice::Name("LABEL"), ALL).unwrap_err().to_string();
    assert!(failure.contains("TFORM = '3A' in column LABEL"), "{failure}");
}

#[test]
fn what_is_written_is_read_at_every_resolution_and_ordering() {
    for nside in [1, 2, 4, 8, 16, 32, 64] {
        for ordering in [Ordering::Ring, Ordering::Nested] {
            let bytes = ours(nside, ordering);
            assert_eq!(bytes.len() % 2880, 0);
            let map = column(&bytes, "HITS").unwrap();
            assert_eq!((map.nside.get(), map.ordering), (nside, ordering));
            assert_eq!(map.values.len(), 12 * (nside * nside) as usize);
            expect(&map.values, &[], |p| p * 8_589_934_592.0);
            expect(&column(&bytes, "SIGMA").unwrap().values, &[3], f64::sqrt);
            expect(&column(&bytes, "HALF").unwrap().values, &[4], |_| 0.5);
        }
    }
}

#[test]
fn an_unobserved_pixel_is_written_as_healpy_expects_it() {
    let bytes = ours(1, Ordering::Ring);
    assert!(bytes.windows(8).any(|window| window == UNSEEN.to_be_bytes()));
    assert!(bytes.windows(4).any(|window| window == (-1.6375e30_f32).to_be_bytes()));
}

#[test]
fn the_sign_of_u_follows_polcconv() {
    let stokes = |polcconv| {
        let one = |_: u32| 1.0;
        let columns =
            ["I", "Q", "U"].map(|name| Column { name, unit: "K", values: Values::Double(&one) });
        let mut out = Vec::new();
        let header = MapHeader { polcconv, ..header(1, Ordering::Ring) };
        write_maps(&mut out, &header, &columns).unwrap();
        let map = read_stokes_from(&mut &out[..], ALL).unwrap();
        assert_eq!(map.unit, "K");
        (map.q[0], map.u[0], out)
    };
    assert_eq!(stokes(None).1.to_bits(), 1.0_f64.to_bits());
    assert_eq!(stokes(Some(Polcconv::Cosmo)).1.to_bits(), 1.0_f64.to_bits());
    let (q, u, bytes) = stokes(Some(Polcconv::Iau));
    assert_eq!((q.to_bits(), u.to_bits()), (1.0_f64.to_bits(), (-1.0_f64).to_bits()));
    let wrong = altered(&bytes, "'IAU     '", "'HEALPIX '");
    let said = read_stokes_from(&mut &wrong[..], ALL).unwrap_err().to_string();
    assert!(said.contains("'COSMO' or 'IAU' is needed"), "{said}");
}

#[test]
fn several_tables_stand_in_one_file_and_the_first_map_is_read() {
    let (first, second) = (|_: u32| 1_i64, |_: u32| 2_i64);
    let column_of = |values| [Column { name: "HITS", unit: "", values: Values::Integer(values) }];
    let mut out = Vec::new();
    write_primary(&mut out).unwrap();
    write_table(&mut out, &header(1, Ordering::Ring), &column_of(&first)).unwrap();
    write_table(&mut out, &header(1, Ordering::Ring), &column_of(&second)).unwrap();
    expect(&column(&out, "HITS").unwrap().values, &[], |_| 1.0);
}

#[test]
fn a_wrong_file_is_refused_in_a_sentence() {
    let good = ours(4, Ordering::Ring);
    let card = |text: &str| format!("{text:<30}");
    let cases: [(Vec<u8>, &str); 15] = [
        (Vec::new(), "it is empty"),
        (b"\x1f\x8b\x08 and more".to_vec(), "unpack it first"),
        (b"pixel,value\n0,1\n".to_vec(), "is no FITS file"),
        (good[..2880].to_vec(), "PIXTYPE = 'HEALPIX'"),
        (good[..4000].to_vec(), "it ends within a header"),
        (good[..good.len() - 2880].to_vec(), "it ends within its table"),
        (altered(&good, "'HEALPIX '", "'FLAT    '"), "PIXTYPE = 'HEALPIX'"),
        (altered(&good, "ORDERING", "ORDURING"), "ORDERING = nothing; 'RING' or 'NESTED'"),
        (altered(&good, "'RING    '", "'SPIRAL  '"), "ORDERING = 'SPIRAL'"),
        (
            altered(&good, &card("NSIDE   =                    4"), &card("NSIDE   = 3")),
            "NSIDE = 3; a power of two",
        ),
        (
            altered(&good, &card("NSIDE   =                    4"), &card("NSIDE   = 8192")),
            "from 1 to 2048",
        ),
        (
            altered(&good, &card("LASTPIX =                  191"), &card("LASTPIX = 100")),
            "pixels 0 to 100; a whole sky, 0 to 191",
        ),
        (altered(&good, "'IMPLICIT'", "'EXPLICIT'"), "lists pixel 8589934592 in column HITS"),
        (altered(&good, "'E       '", "'X       '"), "COORDSYS = 'X'"),
        (altered(&good, "'1K      '", "'9K      '"), "the sum of the columns' widths"),
    ];
    for (bytes, sentence) in cases {
        let said = refusal(&bytes);
        assert!(said.contains(sentence), "{said}, not {sentence}");
    }
    let ecliptic = Frames { accepted: &[MapFrame::Ecliptic], unsaid: None };
    let file = data("stokes_ring_f32.fits");
    let said = read_stokes(&file, ecliptic).unwrap_err();
    let said = said.to_string();
    assert!(said.contains("stokes_ring_f32.fits says COORDSYS = 'G'; 'E' (ecliptic)"), "{said}");
    let said = read_map(&data("packed_ring_i16.fits"), ColumnChoice::Index(0), ALL).unwrap_err();
    assert!(said.to_string().contains("COORDSYS = nothing"), "{said}");
    let said = column(&good, "VISITS").unwrap_err().to_string();
    assert!(said.contains("no column VISITS; its columns are HITS, SIGMA, HALF"), "{said}");
    let said = read_stokes(&data("named_nested_f64.fits"), ALL).unwrap_err().to_string();
    assert!(said.contains("has 2 column(s) (HITS, SIGMA); I, Q and U are needed"), "{said}");
    let said = read_map(&data("no such file"), ColumnChoice::Index(0), ALL).unwrap_err();
    assert!(said.to_string().starts_with("cannot read "), "{said}");
    let fewer = altered(
        &altered(&good, &card("NSIDE   =                    4"), &card("NSIDE   = 2")),
        &card("LASTPIX =                  191"),
        &card("LASTPIX = 47"),
    );
    let said = refusal(&fewer);
    assert!(said.contains("192 values in column SIGMA; NSIDE = 2 needs 48"), "{said}");
}

#[test]
fn sizes_that_a_header_claims_are_not_believed() {
    let good = ours(4, Ordering::Ring);
    let rows = format!("NAXIS2  = {:>20}", 192);
    let more = format!("NAXIS2  = {:>20}", i64::MAX);
    assert!(refusal(&altered(&good, &rows, &more)).contains("values in column SIGMA"));
    // An image of 8 EB before the table.
    let mut image = Vec::new();
    for card in [
        "SIMPLE  = T",
        "BITPIX  = 8",
        "NAXIS   = 2",
        "NAXIS1  = 2147483648",
        "NAXIS2  = 4294967295",
        "END",
    ] {
        image.extend(format!("{card:<80}").bytes());
    }
    image.resize(2880, b' ');
    assert!(refusal(&image).contains("cut short"));
    let endless: Vec<u8> = format!("{:<80}", "SIMPLE  = T").repeat(72_000).into_bytes();
    assert!(refusal(&endless).contains("its END card is missing"));
}

#[test]
fn a_full_disk_is_told_with_the_path_and_leaves_nothing() {
    // Stops as a full disk does, after so many bytes.
    struct Full<'a>(&'a mut dyn std::io::Write, usize);
    impl std::io::Write for Full<'_> {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            if self.1 < bytes.len() {
                return Err(std::io::ErrorKind::StorageFull.into());
            }
            self.1 -= bytes.len();
            self.0.write(bytes)
        }
        fn flush(&mut self) -> std::io::Result<()> {
            self.0.flush()
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("maps.fits");
    let value = |_: u32| 0_i64;
    let columns = [Column { name: "HITS", unit: "", values: Values::Integer(&value) }];
    for room in [0, 2880, 10_000, 100_000] {
        let failure = Sink::File(path.clone())
            .write_with(|out| {
                write_maps(&mut Full(out, room), &header(64, Ordering::Ring), &columns)
            })
            .unwrap_err();
        assert!(matches!(failure, Failure::Input(_)));
        assert!(failure.to_string().contains("maps.fits"), "{failure}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
    #[cfg(target_os = "linux")]
    if let Ok(mut full) = std::fs::OpenOptions::new().write(true).open("/dev/full") {
        let failed = write_maps(&mut full, &header(1, Ordering::Ring), &columns).unwrap_err();
        assert!(matches!(failed, WriteError::Io(_)), "{failed:?}");
    }
}

#[test]
fn an_illegal_card_is_an_error_of_the_program() {
    let header =
        MapHeader { cards: vec![Card::integer("lower case", 1, "")], ..header(1, Ordering::Ring) };
    let value = |_: u32| 0_i64;
    let columns = [Column { name: "HITS", unit: "", values: Values::Integer(&value) }];
    let failed = write_maps(&mut Vec::new(), &header, &columns).unwrap_err();
    assert!(matches!(failed, WriteError::Refused(_)), "{failed:?}");
    let failed = write_table(&mut Vec::new(), &self::header(1, Ordering::Ring), &[]).unwrap_err();
    assert!(matches!(failed, WriteError::Refused(_)), "{failed:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_damaged_file_is_read_or_refused(
        changes in prop::collection::vec((0..8640_usize, any::<u8>()), 1..12),
        digits in prop::collection::vec((0..70_usize, 10..30_usize, b'0'..=b'9'), 0..4),
        length in 0..20_000_usize,
    ) {
        let mut bytes = ours(4, Ordering::Nested);
        for (place, byte) in changes {
            bytes[place] = byte;
        }
        for (card, column, digit) in digits {
            bytes[2880 + card * 80 + column] = digit;
        }
        bytes.truncate(length);
        let _ = column(&bytes, "HITS");
        let _ = read_stokes_from(&mut &bytes[..], ALL);
    }
}
