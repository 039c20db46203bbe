//! The many ways in which an OpenEXR file can hold a picture.

use std::path::{Path, PathBuf};

use exr::prelude::*;
use sungaze::frames::{Footage, Kind, ReadOptions, Wanted, open};
use sungaze::light::Samples;

/// A layer whose samples are 10000 c + 100 y + x, c being the channel's place among `names`.
fn layer(
    names: &[&str],
    size: (usize, usize),
    encoding: Encoding,
) -> Layer<AnyChannels<FlatSamples>> {
    let value = |c: usize| move |i: usize| (10_000 * c + 100 * (i / size.0) + i % size.0) as f32;
    let channels = names.iter().enumerate().map(|(c, name)| {
        let samples: Vec<f32> = (0..size.0 * size.1).map(value(c)).collect();
        AnyChannel::new(*name, FlatSamples::F32(samples))
    });
    Layer::new(size, LayerAttributes::default(), encoding, AnyChannels::sort(channels.collect()))
}

fn saved(
    folder: &Path,
    name: &str,
    layers: Vec<Layer<AnyChannels<FlatSamples>>>,
    display: IntegerBounds,
) -> PathBuf {
    let path = folder.join(name);
    let layers: Layers<_> = layers.into_iter().collect();
    Image::from_layers(ImageAttributes::new(display), layers).write().to_file(&path).unwrap();
    path
}

fn window(x: i32, y: i32, width: usize, height: usize) -> IntegerBounds {
    IntegerBounds::new((x, y), (width, height))
}

fn opened(path: &Path, options: &ReadOptions) -> Box<dyn Footage> {
    open(&[path.to_owned()], options).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(path: &Path, options: &ReadOptions) -> String {
    open(&[path.to_owned()], options).map(|_| ()).expect_err("should be refused").to_string()
}

fn centres(kind: &Kind) -> Vec<f64> {
    match kind {
        Kind::Spectral(bands) => bands.as_slice().iter().map(|band| band.centre).collect(),
        Kind::Rgb(_) => panic!("not spectral"),
    }
}

#[test]
fn tiles_and_scan_lines_in_any_order_are_one_picture() {
    let folder = tempfile::tempdir().unwrap();
    let scan_lines =
        |compression, line_order| Encoding { compression, blocks: Blocks::ScanLines, line_order };
    let tiles = |compression, line_order| Encoding {
        compression,
        blocks: Blocks::Tiles(Vec2(16, 9)),
        line_order,
    };
    for (i, encoding) in [
        scan_lines(Compression::ZIP16, LineOrder::Decreasing),
        scan_lines(Compression::PIZ, LineOrder::Increasing),
        tiles(Compression::RLE, LineOrder::Increasing),
        tiles(Compression::ZIP16, LineOrder::Unspecified),
        tiles(Compression::Uncompressed, LineOrder::Decreasing),
    ]
    .into_iter()
    .enumerate()
    {
        let path = saved(
            folder.path(),
            &format!("{i}.exr"),
            vec![layer(&["R", "G", "B", "A"], (37, 41), encoding)],
            window(0, 0, 37, 41),
        );
        let frame = opened(&path, &ReadOptions::default()).read(0, None, None).unwrap();
        for (x, y, plane) in [(0, 0, 0), (36, 40, 2), (17, 23, 1), (15, 9, 0), (16, 8, 2)] {
            assert_eq!(
                frame.planes.at(x, y, plane),
                (10_000 * plane + 100 * y + x) as f64,
                "{encoding:?}"
            );
        }
    }
}

#[test]
fn the_data_window_lands_where_it_stands_in_the_display_window() {
    let folder = tempfile::tempdir().unwrap();
    let planes = |names: &[&str], x: i32, y: i32, encoding| {
        let mut layer = layer(names, (6, 5), encoding);
        layer.attributes.layer_position = Vec2(x, y);
        let path = saved(folder.path(), "moved.exr", vec![layer], window(10, 20, 8, 7));
        opened(&path, &ReadOptions::default()).read(0, None, None).unwrap().planes
    };
    let tiles = Encoding {
        compression: Compression::ZIP1,
        blocks: Blocks::Tiles(Vec2(4, 3)),
        line_order: LineOrder::Increasing,
    };
    for encoding in [Encoding::SMALL_LOSSLESS, Encoding::UNCOMPRESSED, tiles] {
        for names in [["R", "G", "B"], ["S0.500nm", "S0.550nm", "S0.600nm"]] {
            for (x, y) in [(10, 20), (12, 21), (7, 18), (15, 25), (30, 20), (10, 40), (-90, 20)] {
                let planes = planes(&names, x, y, encoding);
                for (px, py) in (0..8).flat_map(|px| (0..7).map(move |py| (px, py))) {
                    let (dx, dy) = (px + 10 - x, py + 20 - y);
                    let inside = (0..6).contains(&dx) && (0..5).contains(&dy);
                    let expected = if inside { 10_000 + 100 * dy + dx } else { 0 };
                    let found = planes.at(px as usize, py as usize, 1);
                    assert_eq!(found, f64::from(expected), "{names:?} at {x} {y}: {px} {py}");
                }
            }
        }
    }
}

#[test]
fn recycled_planes_leave_no_trace_outside_the_data_window() {
    let folder = tempfile::tempdir().unwrap();
    let path = saved(
        folder.path(),
        "small.exr",
        vec![layer(&["R", "G", "B"], (2, 2), Encoding::UNCOMPRESSED)],
        window(0, 0, 4, 4),
    );
    let footage = opened(&path, &ReadOptions::default());
    let fresh = footage.read(0, None, None).unwrap().planes;
    let mut used = fresh.clone();
    let Samples::Float(samples) = &mut used.samples else { panic!("not float") };
    samples.fill(7.0);
    assert_eq!(footage.read(0, None, Some(used)).unwrap().planes, fresh);
}

#[test]
fn layers_and_parts_are_chosen_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut beauty = layer(&["R", "G", "B"], (4, 4), Encoding::SMALL_LOSSLESS);
    beauty.attributes.layer_name = Some(Text::from("beauty"));
    let mut passes =
        layer(&["sun.B", "sun.G", "sun.R", "depth.Z"], (4, 4), Encoding::SMALL_LOSSLESS);
    passes.attributes.layer_name = Some(Text::from("passes"));
    let path = saved(folder.path(), "parts.exr", vec![beauty, passes], window(0, 0, 4, 4));
    let read = |layer: &str| {
        let options = ReadOptions { layer: layer.into(), ..ReadOptions::default() };
        opened(&path, &options).read(0, None, None).unwrap().planes.at(1, 2, 0)
    };
    assert_eq!((read(""), read("beauty"), read("sun")), (201.0, 201.0, 20_201.0));
    let options = ReadOptions { layer: "moon".into(), ..ReadOptions::default() };
    let message = refused(&path, &options);
    assert!(message.contains("no layer `moon`") && message.contains("`sun`"), "{message}");
}

#[test]
fn luminance_alone_is_grey_and_reflectance_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let save = |names: &[&str]| {
        let layer = layer(names, (3, 2), Encoding::SMALL_LOSSLESS);
        saved(folder.path(), "one.exr", vec![layer], window(0, 0, 3, 2))
    };
    let grey = opened(&save(&["Y"]), &ReadOptions::default());
    let planes = grey.read(0, None, None).unwrap().planes;
    assert_eq!((planes.at(2, 1, 0), planes.at(2, 1, 2)), (102.0, 102.0));
    let message = refused(&save(&["T.400nm", "T.500nm"]), &ReadOptions::default());
    assert!(message.contains("reflectances") && message.contains("S0"), "{message}");
    let message = refused(
        &save(&["R", "G", "B"]),
        &ReadOptions { wanted: Wanted::Spectral, ..Default::default() },
    );
    assert!(message.contains("`R`"), "{message}");
    let message = refused(&save(&["S0.400nm", "S0.0,4um"]), &ReadOptions::default());
    assert!(message.contains("both stand for 400 nm"), "{message}");
}

#[test]
fn wavelengths_sort_by_number_and_polarisation_is_passed_over_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["S0.1000nm", "S0.400nm", "S0.700nm", "S1.400nm", "S2.400nm"];
    let layer = layer(&names, (3, 2), Encoding::SMALL_LOSSLESS);
    let footage = opened(
        &saved(folder.path(), "s.exr", vec![layer], window(0, 0, 3, 2)),
        &ReadOptions::default(),
    );
    assert_eq!(centres(&footage.header().kind), [400.0, 700.0, 1000.0]);
    let planes = footage.read(0, None, None).unwrap().planes;
    assert_eq!([0, 1, 2].map(|i| planes.at(0, 0, i)), [10_000.0, 20_000.0, 0.0]);
    assert!(
        footage.header().notes.iter().any(|note| note.contains("polarisation")),
        "{:?}",
        footage.header().notes
    );
}

#[test]
fn the_older_layouts_of_mitsuba_and_ocean_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let limits = layer(&["400.00-410.00nm", "410.00-430.00nm"], (2, 2), Encoding::SMALL_LOSSLESS);
    let footage = opened(
        &saved(folder.path(), "m.exr", vec![limits], window(0, 0, 2, 2)),
        &ReadOptions::default(),
    );
    assert_eq!(centres(&footage.header().kind), [405.0, 420.0]);
    let mut ocean = layer(&["wl0", "wl1"], (2, 2), Encoding::SMALL_LOSSLESS);
    for (name, metres) in [("wl0.wavelength", 6e-7), ("wl1.wavelength", 5e-7)] {
        ocean.attributes.other.insert(Text::from(name), AttributeValue::F32(metres));
    }
    let footage = opened(
        &saved(folder.path(), "o.exr", vec![ocean], window(0, 0, 2, 2)),
        &ReadOptions::default(),
    );
    let centres = centres(&footage.header().kind);
    assert!((centres[0] - 500.0).abs() < 1e-4 && (centres[1] - 600.0).abs() < 1e-4, "{centres:?}");
    assert_eq!(footage.read(0, None, None).unwrap().planes.at(0, 0, 0), 10_000.0);
}

#[test]
fn a_huge_declared_size_is_refused_before_anything_is_allocated() {
    let folder = tempfile::tempdir().unwrap();
    let layer = layer(&["R", "G", "B"], (4, 4), Encoding::SMALL_LOSSLESS);
    let path = saved(folder.path(), "huge.exr", vec![layer], window(0, 0, 4, 4));
    let original = std::fs::read(&path).unwrap();
    for (corner, expected) in [(99_999i32, "max_pixels"), (15_999, "bytes of pixels in a file of")]
    {
        let mut bytes = original.clone();
        for name in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
            let at = bytes.windows(name.len()).position(|bytes| bytes == name.as_bytes()).unwrap()
                + name.len()
                + 4;
            bytes[at + 8..at + 12].copy_from_slice(&corner.to_le_bytes());
            bytes[at + 12..at + 16].copy_from_slice(&corner.to_le_bytes());
        }
        std::fs::write(&path, bytes).unwrap();
        let message = refused(&path, &ReadOptions::default());
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn empty_cut_and_foreign_files_are_named_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let layer = layer(&["R", "G", "B"], (9, 40), Encoding::SMALL_LOSSLESS);
    let path = saved(folder.path(), "cut.exr", vec![layer], window(0, 0, 9, 40));
    let whole = std::fs::read(&path).unwrap();
    for length in [0, 3, 20, 200, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&path, &whole[..length]).unwrap();
        let read = open(std::slice::from_ref(&path), &ReadOptions::default())
            .and_then(|footage| footage.read(0, None, None));
        let message = read.map(|_| ()).expect_err("should be refused").to_string();
        assert!(message.contains("cut.exr: is "), "{length}: {message}");
    }
    std::fs::write(&path, "not a picture").unwrap();
    let message = refused(&path, &ReadOptions::default());
    assert!(message.contains("cut.exr: cannot be read as OpenEXR"), "{message}");
    let message = refused(Path::new("sun.tiff"), &ReadOptions::default());
    assert!(message.contains("no known format"), "{message}");
}
