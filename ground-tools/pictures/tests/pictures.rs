//! Pictures and charts: what stands where, and that nothing odd stops them.
#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use formats::fits::MapFrame;
use pictures::{
    Axis, Chart, ColourMap, Drawing, Mark, PictureError, Range, Scale, Series, Shape, SkyMap,
    SkyPicture, Track, View, chart, sky_picture,
};
use planner::healpix::{Nside, Ordering};
use roxmltree::Document;
use std::f64::consts::PI;

const ALL: Range = Range::Percentiles(0.0, 100.0);

fn map(ordering: Ordering, values: &(dyn Fn(u32) -> f64 + Sync)) -> SkyMap<'_> {
    SkyMap { nside: Nside::new(64).unwrap(), ordering, frame: MapFrame::Ecliptic, values }
}

fn picture(view: View) -> SkyPicture<'static> {
    SkyPicture {
        title: "Hits & more",
        quantity: "hits",
        unit: "1",
        view,
        width_px: 800,
        scale: Scale::Linear,
        range: ALL,
        colours: ColourMap::Viridis,
        tracks: &[],
    }
}

const SKY: View = View::WholeSky { longitude_rad: 0.0 };

fn texts(drawing: &Drawing) -> Vec<String> {
    let document = Document::parse(drawing.svg()).unwrap();
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    texts.map(|node| node.text().unwrap().to_owned()).collect()
}

/// An image: its width and its pixels.
struct Image(usize, Vec<u8>);

impl Image {
    fn of(drawing: &Drawing) -> Self {
        let bytes = drawing.png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!(info.color_type, png::ColorType::Rgb);
        Self(info.width as usize, pixels)
    }

    fn at(&self, column: usize, row: usize) -> [u8; 3] {
        let start = 3 * (row * self.0 + column);
        [self.1[start], self.1[start + 1], self.1[start + 2]]
    }
}

/// Where the map's image stands in a drawing: left, top, width, height.
fn frame(drawing: &Drawing) -> [f64; 4] {
    let document = Document::parse(drawing.svg()).unwrap();
    let image = document.descendants().find(|node| node.has_tag_name("image")).unwrap();
    ["x", "y", "width", "height"].map(|name| image.attribute(name).unwrap().parse().unwrap())
}

#[test]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "places in a picture")]
fn colours_stand_where_the_values_are() {
    let nside = Nside::new(64).unwrap();
    let longitude = |ring: u32| {
        let lon = nside.center(nside.nested_of_ring(ring)).0;
        if lon > PI { lon - 2.0 * PI } else { lon }
    };
    let values = |ring: u32| longitude(ring).to_degrees();
    let sky = picture(SKY);
    let sky = SkyPicture { range: Range::Given(-180.0, 180.0), ..sky };
    let drawing = sky_picture(&map(Ordering::Ring, &values), &sky).unwrap();
    let [left, top, width, height] = frame(&drawing);
    let image = Image::of(&drawing);
    assert_eq!(image.0, 800);
    // Off the graticule: on Mollweide's plane x is -2 lon/pi cos t where y is sin t.
    for (degrees, y) in
        [(-170.0, 0.1), (-100.0, 0.3), (-14.0, -0.6), (47.0, -0.2), (105.0, 0.62), (166.0, -0.1)]
    {
        let x = -f64::to_radians(degrees) / PI * f64::sqrt(1.0 - y * y);
        let column = left + width * (x + 1.0) / 2.0;
        let row = top + height * (1.0 - y) / 2.0;
        let found = image.at(column as usize, row as usize);
        let wanted = colorous::VIRIDIS.eval_continuous((degrees + 180.0) / 360.0);
        for (found, wanted) in found.into_iter().zip([wanted.r, wanted.g, wanted.b]) {
            assert!(found.abs_diff(wanted) <= 4, "{degrees} deg: {found} instead of {wanted}");
        }
    }
    assert_eq!(image.at(3, 3), [255; 3]);
}

#[test]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "places in a picture"
)]
fn a_patch_shows_its_centre_north_up_and_east_left() {
    // One pixel apart from the others to the north-east of the centre; unobserved to the south.
    let nside = Nside::new(64).unwrap();
    let (lon, lat) = (1.0, 0.5);
    let spot = nside.pixel_at(lon + 0.1, lat + 0.1);
    let values = |nested: u32| match nside.center(nested) {
        _ if nested == spot => 1.0,
        (_, latitude) if latitude < lat - 0.05 => f64::NAN,
        _ => 0.0,
    };
    let view = View::Patch { longitude_rad: lon, latitude_rad: lat, side_rad: 0.5 };
    let drawing = sky_picture(&map(Ordering::Nested, &values), &picture(view)).unwrap();
    let [left, top, width, height] = frame(&drawing);
    let image = Image::of(&drawing);
    let yellow = (0..width as usize)
        .flat_map(|column| (0..height as usize).map(move |row| (column, row)))
        .filter(|&(column, row)| {
            image.at(column + left as usize, row + top as usize) == [253, 231, 37]
        });
    let (mut count, mut column, mut row) = (0.0, 0.0, 0.0);
    for (x, y) in yellow {
        (count, column, row) = (count + 1.0, column + x as f64, row + y as f64);
    }
    assert!(count > 100.0);
    assert!((0.2..0.35).contains(&(column / count / width)), "{}", column / count / width);
    assert!((0.2..0.35).contains(&(row / count / height)), "{}", row / count / height);
    let south = image.at((left + 0.53 * width) as usize, (top + 0.9 * height) as usize);
    assert_eq!(south, [190; 3], "unobserved is grey");
    assert!(texts(&drawing).contains(&"not observed".to_owned()));
}

#[test]
fn numbers_names_and_units_are_written() {
    let values = |ring: u32| f64::from(ring);
    let line: Vec<_> = (0..40).map(|k| (f64::from(k) * 0.1, 0.02)).collect();
    let hidden: Vec<_> = (0..10).map(|k| (3.0 + f64::from(k) * 0.01, -1.2)).collect();
    let tracks =
        [Track { name: "Jupiter", points: &line }, Track { name: "Nowhere", points: &hidden }];
    let sky = SkyPicture { tracks: &tracks, ..picture(SKY) };
    let drawing = sky_picture(&map(Ordering::Ring, &values), &sky).unwrap();
    let found = texts(&drawing);
    let wanted = [
        "Hits & more",
        "0°",
        "60°",
        "120°",
        "240°",
        "300°",
        "+30°",
        "−60°",
        "hits [1]",
        "Jupiter",
        "20000",
        "ecliptic coordinates, longitude increases to the left",
    ];
    for wanted in wanted {
        assert!(found.iter().any(|text| text == wanted), "{wanted} is not in {found:?}");
    }
    let view = View::Patch { longitude_rad: 1.0, latitude_rad: 0.0, side_rad: 0.2 };
    let sky = SkyPicture { view, ..sky };
    let found = texts(&sky_picture(&map(Ordering::Ring, &values), &sky).unwrap());
    assert!(found.contains(&"Jupiter".to_owned()) && !found.contains(&"Nowhere".to_owned()));
    assert!(found.iter().any(|text| text == "56°" || text == "58°"), "{found:?}");
}

#[test]
fn a_track_over_the_edge_is_cut_there() {
    let values = |_: u32| 1.0;
    let line: Vec<_> = (0..=100).map(|k| (f64::from(k) * 0.02 + 2.1, 0.1)).collect();
    let tracks = [Track { name: "Mars", points: &line }];
    let sky = SkyPicture { tracks: &tracks, ..picture(SKY) };
    let drawing = sky_picture(&map(Ordering::Ring, &values), &sky).unwrap();
    let [_, _, width, _] = frame(&drawing);
    let document = Document::parse(drawing.svg()).unwrap();
    for path in document.descendants().filter(|node| node.has_tag_name("path")) {
        let data = path.attribute("d").unwrap();
        let xs: Vec<f64> = data[1..]
            .split('L')
            .map(|point| point.split(' ').next().unwrap().parse().unwrap())
            .collect();
        for (from, to) in xs.iter().zip(&xs[1..]).filter(|_| xs.len() > 10) {
            assert!((from - to).abs() < width / 8.0, "{from} to {to}");
        }
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let values = |ring: u32| f64::from(ring % 1000);
    let draw = || sky_picture(&map(Ordering::Ring, &values), &picture(SKY)).unwrap();
    let (first, second) = (draw(), draw());
    assert_eq!(first, second);
    assert_eq!(first.png().unwrap(), second.png().unwrap());
}

#[test]
fn odd_maps_are_drawn() {
    let infinite = |pixel: u32| if pixel.is_multiple_of(2) { f64::INFINITY } else { -1e300 };
    let maps: [&(dyn Fn(u32) -> f64 + Sync); 5] =
        [&|_| f64::NAN, &|_| 7.0, &|_| 0.0, &|_| -3.0, &infinite];
    let pole = View::Patch { longitude_rad: 7.0, latitude_rad: -PI / 2.0, side_rad: 2.6 };
    let tiny = View::Patch { longitude_rad: -20.0, latitude_rad: 1.57, side_rad: 1e-5 };
    for values in maps {
        for scale in [Scale::Linear, Scale::Log] {
            for colours in [ColourMap::Viridis, ColourMap::Cividis, ColourMap::BlueRed] {
                for view in [View::WholeSky { longitude_rad: 4.0 }, pole, tiny] {
                    let sky = SkyPicture { scale, colours, width_px: 200, ..picture(view) };
                    let drawing = sky_picture(&map(Ordering::Nested, values), &sky).unwrap();
                    Document::parse(drawing.svg()).unwrap();
                    drawing.png().unwrap();
                }
            }
        }
    }
}

#[test]
fn what_cannot_be_drawn_is_told() {
    let values = |_: u32| 1.0;
    let wrong = |sky: SkyPicture| sky_picture(&map(Ordering::Ring, &values), &sky).unwrap_err();
    let good = picture(SKY);
    assert_eq!(wrong(SkyPicture { width_px: 20, ..good }), PictureError::Width(20));
    assert_eq!(
        wrong(SkyPicture { range: Range::Given(3.0, 3.0), ..good }),
        PictureError::Range(3.0, 3.0)
    );
    let scale = Scale::Log;
    let below = Range::Given(-1.0, 3.0);
    assert_eq!(
        wrong(SkyPicture { range: below, scale, ..good }),
        PictureError::Logarithm(-1.0, 3.0)
    );
    let patch = |latitude_rad, side_rad| {
        picture(View::Patch { longitude_rad: 0.0, latitude_rad, side_rad })
    };
    assert!(wrong(patch(0.0, 3.0)).to_string().contains("up to 150"));
    assert!(wrong(patch(0.0, f64::NAN)).to_string().contains("up to 150"));
    assert!(wrong(patch(2.0, 0.1)).to_string().contains("-90 to 90"));
}

fn histogram(scale: Scale) -> Drawing {
    let edges: Vec<f64> = (0..=20).map(|k| 10_f64.powf(f64::from(k) / 5.0)).collect();
    let counts: Vec<f64> = (0..20).map(|k| f64::from((k * 7) % 11) * 40.0).collect();
    let axis = |quantity, unit| Axis { quantity, unit, scale, range: None };
    let shape = Shape::Histogram { edges: &edges, counts: &counts };
    chart(&Chart {
        title: "Revisits",
        x: axis("revisit time", "min"),
        y: axis("visits", ""),
        series: &[Series { name: "pole", shape }, Series { name: "equator <2>", shape }],
        marks: &[
            Mark { at: 20.0, name: "spin" },
            Mark { at: 192.348, name: "precession" },
            Mark { at: 0.0, name: "none" },
        ],
        bands: &[],
        width_px: 700,
        height_px: 450,
    })
    .unwrap()
}

#[test]
fn a_histogram_has_its_names_marks_and_units() {
    let found = texts(&histogram(Scale::Log));
    let wanted = [
        "Revisits",
        "revisit time [min]",
        "visits",
        "pole",
        "equator <2>",
        "spin",
        "precession",
        "1000",
    ];
    for wanted in wanted {
        assert!(found.iter().any(|text| text == wanted), "{wanted} is not in {found:?}");
    }
    assert!(!found.contains(&"none".to_owned()), "a mark outside the axis is left out");
    assert!(texts(&histogram(Scale::Linear)).contains(&"none".to_owned()));
    let image = Image::of(&histogram(Scale::Log));
    assert_eq!((image.0, image.1.len()), (700, 700 * 450 * 3));
}

#[test]
fn odd_charts_are_drawn_or_told() {
    let axis = |scale| Axis { quantity: "q", unit: "", scale, range: None };
    let lines: [&[(f64, f64)]; 6] = [
        &[],
        &[(1.0, 1.0)],
        &[(f64::NAN, 1.0), (2.0, f64::INFINITY)],
        &[(0.0, 0.0), (0.0, 0.0)],
        &[(-1e300, 1e300), (1e300, -1e300)],
        &[(1.0, 2.0), (2.0, f64::NAN), (3.0, 4.0), (4.0, 5.0)],
    ];
    for points in lines {
        for scale in [Scale::Linear, Scale::Log] {
            let drawing = chart(&Chart {
                title: "",
                x: axis(scale),
                y: axis(scale),
                series: &[Series { name: "", shape: Shape::Line(points) }],
                marks: &[Mark { at: f64::NAN, name: "nowhere" }],
                bands: &[],
                width_px: 200,
                height_px: 150,
            })
            .unwrap();
            Document::parse(drawing.svg()).unwrap();
            assert!(!drawing.svg().contains("NaN") && !drawing.svg().contains("inf"));
            drawing.png().unwrap();
        }
    }
    let shape = Shape::Histogram { edges: &[1.0, 1.0], counts: &[2.0] };
    let failure = chart(&Chart {
        title: "",
        x: axis(Scale::Linear),
        y: axis(Scale::Linear),
        series: &[Series { name: "flat", shape }],
        marks: &[],
        bands: &[],
        width_px: 400,
        height_px: 300,
    })
    .unwrap_err();
    assert!(failure.to_string().contains("edges must rise"), "{failure}");
}
