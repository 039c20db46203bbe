//! OpenEXR files as they turn up, beyond what the format's own library writes by default.

mod exr_raw;

use std::path::{Path, PathBuf};

use exr_blocks::header::{Attribute, DEEP};
use exr_raw::{chunk, constant, file, floats, ints, luminance_and_chroma, part};
use half::f16;
use sungaze::colour::Primaries;
use sungaze::frames::{Footage, Kind, ReadOptions, inspect, open};

fn saved(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

fn opened(path: &Path, options: &ReadOptions) -> Box<dyn Footage> {
    open(&[path.to_owned()], options).unwrap_or_else(|error| panic!("{error}"))
}

/// The pixel at column 1 of row 1.
fn pixel(path: &Path, options: &ReadOptions) -> [f64; 3] {
    let planes = opened(path, options).read(0, None, None).unwrap().planes;
    [0, 1, 2].map(|plane| planes.at(1, 1, plane))
}

fn notes(path: &Path) -> String {
    opened(path, &ReadOptions::default()).header().notes.join("; ")
}

#[test]
fn a_dwa_block_that_would_not_shrink_is_stored_raw_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let values: Vec<f16> = (0..3 * 5 * 4).map(|i| f16::from_f32(i as f32)).collect();
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let rgb = [("B", 1, [1, 1]), ("G", 1, [1, 1]), ("R", 1, [1, 1])];
    for compression in [8, 9] {
        let header = part(&rgb, compression, [0, 0, 4, 3]);
        let path =
            saved(folder.path(), "raw.exr", &file(0, vec![(header, vec![chunk(0, &bytes)])]));
        assert_eq!(pixel(&path, &ReadOptions::default()), [26.0, 21.0, 16.0]);
    }
}

#[test]
fn channels_x_y_z_are_colours_and_not_a_grey_sun() {
    let folder = tempfile::tempdir().unwrap();
    let xyz = constant(&[("X", 0.6), ("Y", 0.35), ("Z", 0.05)], vec![]);
    let path = saved(folder.path(), "xyz.exr", &xyz);
    assert_eq!(opened(&path, &ReadOptions::default()).header().kind, Kind::Rgb(Primaries::XYZ));
    assert_eq!(pixel(&path, &ReadOptions::default()), [0.6f32, 0.35, 0.05].map(f64::from));
    assert!(notes(&path).contains("CIE XYZ"), "{}", notes(&path));
    let depth = constant(&[("R", 1.0), ("G", 2.0), ("B", 3.0), ("Z", 9.0)], vec![]);
    let path = saved(folder.path(), "depth.exr", &depth);
    assert_eq!(pixel(&path, &ReadOptions::default()), [1.0, 2.0, 3.0]);
}

#[test]
fn chromaticities_of_xyz_in_channels_r_g_b_are_a_gamut() {
    let folder = tempfile::tempdir().unwrap();
    let third = 1.0 / 3.0;
    let points = floats(&[1.0, 0.0, 0.0, 1.0, 0.0, 0.0, third, third]);
    let attribute = Attribute::new("chromaticities", "chromaticities", points);
    let bytes = constant(&[("R", 0.5), ("G", 0.5), ("B", 0.5)], vec![attribute]);
    let footage = opened(&saved(folder.path(), "a.exr", &bytes), &ReadOptions::default());
    let Kind::Rgb(primaries) = &footage.header().kind else { panic!("not RGB") };
    assert!(primaries.agrees(&Primaries::XYZ), "{primaries:?}");
    assert!(sungaze::colour::to_rec709(primaries).is_some());
}

#[test]
fn one_channel_is_grey_and_other_spellings_are_colours() {
    let folder = tempfile::tempdir().unwrap();
    let read = |channels: &[(&str, f32)]| {
        let path = saved(folder.path(), "a.exr", &constant(channels, vec![]));
        (pixel(&path, &ReadOptions::default()), notes(&path))
    };
    for name in ["R", "Y", "L", "luminance", "g"] {
        let (pixel, notes) = read(&[(name, 0.5), ("A", 1.0)]);
        assert_eq!(pixel, [0.5; 3], "{name}");
        assert!(notes.contains(&format!("only a channel `{name}`: read as grey")), "{notes}");
    }
    for names in [["r", "g", "b"], ["red", "green", "blue"], ["Red", "Green", "Blue"]] {
        let channels: Vec<_> = names.into_iter().zip([1.0, 2.0, 3.0]).collect();
        assert_eq!(read(&channels).0, [1.0, 2.0, 3.0], "{names:?}");
    }
    let two = saved(folder.path(), "two.exr", &constant(&[("R", 1.0), ("G", 2.0)], vec![]));
    let message = open(&[two], &ReadOptions::default()).map(|_| ()).unwrap_err().to_string();
    assert!(message.contains("`R`") && message.contains("read as grey"), "{message}");
}

#[test]
fn names_beyond_ascii_are_found_and_shown_as_they_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let names = ["R", "G", "B"].map(|name| format!("Réflexion.{name}"));
    let channels: Vec<_> = names.iter().map(|name| (name.as_str(), 0.5)).collect();
    let owner = Attribute::new("owner", "string", "Zoë".as_bytes());
    let latin = Attribute::new("comments", "string", *b"caf\xe9");
    let path = saved(folder.path(), "a.exr", &constant(&channels, vec![owner, latin]));
    let options = ReadOptions { layer: "Réflexion".into(), ..ReadOptions::default() };
    assert_eq!(pixel(&path, &options), [0.5; 3]);
    let told = inspect(&path, &options, &|_| None).unwrap().exr.unwrap();
    assert_eq!(told.channels[0].name, "Réflexion.B");
    assert_eq!((&*told.attributes["owner"], &*told.attributes["comments"]), ("Zoë", "café"));
}

#[test]
fn each_frame_is_scaled_by_its_own_white_luminance() {
    let folder = tempfile::tempdir().unwrap();
    let paths = [100.0f32, 200.0, 300.0].map(|white| {
        let attribute = Attribute::new("whiteLuminance", "float", floats(&[white]));
        let bytes = constant(&[("R", 1.0), ("G", 2.0), ("B", 4.0)], vec![attribute]);
        saved(folder.path(), &format!("{white}.exr"), &bytes)
    });
    let red = |own_white: bool, frame: usize| {
        let options = ReadOptions { own_white, ..ReadOptions::default() };
        open(&paths, &options).unwrap().read(frame, None, None).unwrap().planes.at(0, 0, 0)
    };
    assert_eq!([red(true, 0), red(true, 1), red(true, 2)], [1.0, 2.0, 3.0]);
    assert_eq!([red(false, 0), red(false, 2)], [1.0, 1.0], "the configuration's white stands");
}

#[test]
fn chromaticities_that_differ_in_the_seventh_digit_are_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let save = |y: f32| {
        let points = floats(&[0.64, y, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329]);
        let attribute = Attribute::new("chromaticities", "chromaticities", points);
        let bytes = constant(&[("R", 1.0), ("G", 1.0), ("B", 1.0)], vec![attribute]);
        saved(folder.path(), &format!("{y}.exr"), &bytes)
    };
    let paths = [save(0.33), save(0.330_000_1), save(0.34)];
    let footage = open(&paths, &ReadOptions::default()).unwrap();
    assert!(footage.read(1, None, None).is_ok());
    let message = footage.read(2, None, None).map(|_| ()).unwrap_err().to_string();
    assert!(message.contains("primaries"), "{message}");
}

#[test]
fn a_flat_part_beside_a_deep_one_is_read_and_the_deep_one_named() {
    let folder = tempfile::tempdir().unwrap();
    let named = |name: &str, kind: &str, count: i32| {
        vec![
            Attribute::new("name", "string", name),
            Attribute::new("type", "string", kind),
            Attribute::new("chunkCount", "int", ints(&[count])),
        ]
    };
    let rgb = [("B", 2, [1, 1]), ("G", 2, [1, 1]), ("R", 2, [1, 1])];
    let row = floats(&[3.0, 3.0, 2.0, 2.0, 1.0, 1.0]);
    let flat = [part(&rgb, 0, [0, 0, 1, 1]), named("beauty", "scanlineimage", 2)].concat();
    let version = Attribute::new("version", "int", ints(&[1]));
    let deep = [part(&[("Z", 2, [1, 1])], 0, [0, 0, 1, 1]), named("deep", "deepscanline", 2)];
    let deep = [deep.concat(), vec![version]].concat();
    let samples = |y| [ints(&[y]), vec![8, 0, 0, 0, 0, 0, 0, 0], vec![0; 16 + 8]].concat();
    let flat = (flat, vec![chunk(0, &row), chunk(1, &row)]);
    let deep = (deep, vec![samples(0), samples(1)]);
    let both = [vec![deep.clone(), flat.clone()], vec![flat, deep]];
    for parts in both {
        let path = saved(folder.path(), "both.exr", &file(DEEP, parts));
        for layer in ["", "beauty"] {
            let options = ReadOptions { layer: layer.into(), ..ReadOptions::default() };
            assert_eq!(pixel(&path, &options), [1.0, 2.0, 3.0]);
        }
        let options = ReadOptions { layer: "deep".into(), ..ReadOptions::default() };
        let message = open(&[path], &options).map(|_| ()).unwrap_err().to_string();
        assert!(message.contains("deep data"), "{message}");
    }
}

#[test]
fn no_control_character_of_a_file_reaches_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let owner = Attribute::new("owner", "string", *b"\x1b[31mred\x1b]0;title\x07");
    let odd = Attribute::new("a\x1b[2J", "string", *b"\xc2\x9b31m");
    let channels = [("R", 1.0), ("G", 1.0), ("B", 1.0), ("x\x1b[1m", 1.0)];
    let path = saved(folder.path(), "a.exr", &constant(&channels, vec![owner, odd]));
    let told = inspect(&path, &ReadOptions::default(), &|_| None).unwrap();
    let text = format!("{told}{}", told.notes.join("\n"));
    assert!(text.contains("red") && text.chars().all(|c| c == '\n' || !c.is_control()), "{text:?}");
}

#[test]
fn luminance_and_chroma_become_red_green_and_blue() {
    let folder = tempfile::tempdir().unwrap();
    for (compression, lines) in [(0, 1), (2, 1), (3, 16)] {
        for window in [[0, 0, 7, 33], [-4, 6, 11, 27]] {
            let bytes = luminance_and_chroma(compression, lines, window);
            let path = saved(folder.path(), "yc.exr", &bytes);
            let planes = opened(&path, &ReadOptions::default()).read(0, None, None).unwrap().planes;
            for (x, y) in [(0, 0), (1, 0), (0, 1), (5, 17), (7, planes.height - 1)] {
                let luminance = 1.0 + (x as f64 + y as f64 + f64::from(window[1])) / 64.0;
                let (red, blue) = (1.25 * luminance, 0.5 * luminance);
                let green = (luminance - 0.2126 * red - 0.0722 * blue) / 0.7152;
                for (plane, expected) in [red, green, blue].into_iter().enumerate() {
                    let found = planes.at(x, y, plane);
                    let same = (found / expected - 1.0).abs() < 2e-4;
                    assert!(same, "{compression} {window:?} {x} {y}: {found} {expected}");
                }
            }
        }
    }
}

#[test]
fn a_sampling_that_does_not_divide_the_picture_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (sampling, window) in
        [([2, 2], [0, 0, 4, 3]), ([2, 2], [1, 0, 4, 3]), ([0, 1], [0, 0, 3, 3])]
    {
        let channels = [("BY", 2, sampling), ("RY", 2, sampling), ("Y", 2, [1, 1])];
        let bytes = file(0, vec![(part(&channels, 0, window), vec![chunk(0, &[0; 64]); 4])]);
        let path = saved(folder.path(), "odd.exr", &bytes);
        let read = open(&[path], &ReadOptions::default()).and_then(|f| f.read(0, None, None));
        let message = read.map(|_| ()).unwrap_err().to_string();
        assert!(message.contains("odd.exr: "), "{message}");
    }
}
