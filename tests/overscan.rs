//! Frames whose data reach beyond their display window: what lies there is seen and written too,
//! while fractions and the field of view go by the display window.

mod exr_raw;

use std::path::{Path, PathBuf};
use std::process::Command;

use exr::prelude::f16;
use exr_blocks::header::Headers;
use exr_raw::{Channel, chunk, file, ints, part};
use sungaze::frames::{Overscan, ReadOptions, decode_png, open, read_exr};
use sungaze::light::{Planes, Window};

/// Left, top, right and bottom: 24 x 16 pixels, and 12 x 8 of them, 6 from the left, 4 from the top.
const DATA: [i32; 4] = [4, 16, 27, 31];
const DISPLAY: [i32; 4] = [10, 20, 21, 27];
const CHANNELS: [Channel; 4] =
    [("B", 1, [1, 1]), ("G", 1, [1, 1]), ("R", 1, [1, 1]), ("Z", 2, [1, 1])];

/// The light of a pixel of the data window: a slope, and a lamp in its upper left corner.
fn light(column: i32, row: i32, channel: usize, lamp: f32) -> f32 {
    let slope = 0.25 + (column * (channel as i32 + 1) + row) as f32 / 64.0;
    if column < 3 && row < 3 { slope + lamp } else { slope }
}

/// A frame with these windows; data are always the light of their places in [`DATA`].
fn frame(path: &Path, display: [i32; 4], data: [i32; 4], lamp: f32) -> PathBuf {
    let mut header = part(&CHANNELS, 0, data);
    for attribute in header.iter_mut().filter(|attribute| attribute.name == b"displayWindow") {
        attribute.value = ints(&display);
    }
    let samples = |y: i32, channel: usize| -> Vec<u8> {
        let value = |x: i32| light(x - DATA[0], y - DATA[1], channel, lamp);
        let bytes = |x: i32| match channel {
            3 => value(x).to_le_bytes().to_vec(),
            _ => f16::from_f32(value(x)).to_le_bytes().to_vec(),
        };
        (data[0]..=data[2]).flat_map(bytes).collect()
    };
    let row =
        |y: i32| chunk(y, &(0..4).flat_map(|channel| samples(y, channel)).collect::<Vec<_>>());
    let rows = (data[1]..=data[3]).map(row).collect();
    std::fs::write(path, file(0, vec![(header, rows)])).unwrap();
    path.to_owned()
}

/// Runs a frame, or several, into a folder of this name.
fn run(folder: &Path, frames: &str, out: &str, keys: &[String]) -> PathBuf {
    let out = folder.join(out);
    let sets = keys.iter().flat_map(|key| ["--set", key]);
    let output = Command::new(env!("CARGO_BIN_EXE_sungaze"))
        .args(["run", "--quiet", "--white", "200000", "--out"])
        .args([out.as_os_str(), folder.join(frames).as_os_str()])
        .args(sets)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    out
}

fn keys(list: &[&str]) -> Vec<String> {
    list.iter().map(|key| key.to_string()).collect()
}

/// Field of view, gaze and probe in fractions of a picture.
fn view(across: f64, gaze: [f64; 2], probe: [f64; 2]) -> Vec<String> {
    vec![
        format!("input.horizontal_fov_deg={across}"),
        format!("gaze.at={gaze:?}"),
        format!("output.probe=[{{name=\"p\", at={probe:?}}}]"),
        "time.times_s=[0, 0.5, 2]".into(),
    ]
}

/// Red, green, blue and depth of a percept, over its whole data window.
fn seen(out: &Path, number: u32) -> Planes {
    let path = out.join(format!("seen.{number:04}.exr"));
    let mut bytes = std::fs::read(&path).unwrap();
    // Read with its data window for a display window.
    let name = b"displayWindow\0box2i\0\x10\0\0\0";
    let at = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len();
    bytes[at..at + 16].copy_from_slice(&ints(&DATA));
    std::fs::write(&path, bytes).unwrap();
    read_exr(&path, &["R", "G", "B", "Z"], 1 << 20).unwrap().0
}

/// A table without some of its columns.
fn table(out: &Path, name: &str, without: &[usize]) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(out.join(name)).unwrap();
    let kept = |(i, cell): (usize, &str)| (!without.contains(&i)).then(|| cell.to_owned());
    text.lines().map(|line| line.split(',').enumerate().filter_map(kept).collect()).collect()
}

#[test]
fn a_frame_with_overscan_is_seen_as_the_larger_picture_that_it_is() {
    let folder = tempfile::tempdir().unwrap();
    frame(&folder.path().join("plate.exr"), DISPLAY, DATA, 300.0);
    frame(&folder.path().join("whole.exr"), DATA, DATA, 300.0);
    for psf in ["none", "cie"] {
        let psf = [format!("optics.psf={psf}"), "output.state=every".into()];
        // Half a degree a pixel; (6 + .25 * 12, 4 + .5 * 8) of 24 x 16; pixel (6 + 11, 4 + 7).
        let of_plate = [view(6.0, [0.25, 0.5], [0.99, 1.0]), psf.to_vec()].concat();
        let of_whole =
            [view(12.0, [0.375, 0.5], [17.5 / 24.0, 11.5 / 16.0]), psf.to_vec()].concat();
        let plate = run(folder.path(), "plate.exr", &format!("plate {}", psf[0]), &of_plate);
        let whole = run(folder.path(), "whole.exr", &format!("whole {}", psf[0]), &of_whole);
        for number in [1, 2] {
            assert_eq!(seen(&plate, number), seen(&whole, number));
        }
        assert_eq!(table(&plate, "probes.csv", &[]), table(&whole, "probes.csv", &[]));
        assert_eq!(table(&plate, "trace.csv", &[3, 4]), table(&whole, "trace.csv", &[3, 4]));
        let gaze = &table(&plate, "trace.csv", &[])[1][3..5];
        assert_eq!(gaze, ["0.25", "0.5"]);
        let state = |out: &Path| read_exr(&out.join("state.0002.exr"), &["unbleached.L"], 1 << 20);
        assert_eq!(state(&plate).unwrap().0, state(&whole).unwrap().0);
        // The display shows its window: that part of the larger picture.
        let png =
            |out: &Path| decode_png(&std::fs::read(out.join("display.0002.png")).unwrap()).unwrap();
        let (shown, larger) = (png(&plate), png(&whole));
        assert_eq!((shown.0, shown.1), (12, 8));
        for (y, row) in shown.2.chunks_exact(36).enumerate() {
            assert_eq!(row, &larger.2[72 * (y + 4) + 18..][..36], "row {y}");
        }
    }
}

#[test]
fn where_nothing_is_bleached_overscan_comes_back_in_its_windows() {
    let folder = tempfile::tempdir().unwrap();
    let source = frame(&folder.path().join("plate.exr"), DISPLAY, DATA, 9.0);
    let keys = [view(6.0, [0.5; 2], [0.5; 2]), keys(&["numerics.model=none"])].concat();
    let out = run(folder.path(), "plate.exr", "o", &keys);
    let windows = |path: &Path| {
        let headers = Headers::read(&mut &std::fs::read(path).unwrap()[..]).unwrap();
        let windows = headers.parts[0].iter().filter(|a| a.name.ends_with(b"Window"));
        windows.cloned().collect::<Vec<_>>()
    };
    assert_eq!(windows(&out.join("seen.0001.exr")), windows(&source));
    let planes = seen(&out, 1);
    for (x, y, plane) in (0..24 * 16 * 4).map(|i| (i % 24, i / 24 % 16, i / 384)) {
        let channel = [2, 1, 0, 3][plane];
        let expected = light(x as i32, y as i32, channel, 9.0);
        let expected = if plane < 3 { f16::from_f32(expected).to_f32() } else { expected };
        assert_eq!(planes.at(x, y, plane) as f32, expected, "{x} {y} {plane}");
    }
}

#[test]
fn a_lamp_in_the_overscan_veils_what_the_display_shows() {
    let folder = tempfile::tempdir().unwrap();
    let veiled = |name: &str, lamp: f32, psf: &str| -> f64 {
        frame(&folder.path().join(name), DISPLAY, DATA, lamp);
        let more = keys(&[
            "numerics.model=none",
            &format!("optics.psf={psf}"),
            "observer.pupil=fixed",
            "observer.pupil_mm=3",
        ]);
        let keys = [view(6.0, [0.5; 2], [0.1, 0.1]), more].concat();
        let out = run(folder.path(), name, &format!("{name} {psf}"), &keys);
        table(&out, "probes.csv", &[])[1][10].parse().unwrap()
    };
    let (dark, lit) = (veiled("dark.exr", 0.0, "cie"), veiled("lit.exr", 3000.0, "cie"));
    assert!(lit > 1.2 * dark, "{lit} {dark}");
    assert_eq!(veiled("lit.exr", 3000.0, "none"), veiled("dark.exr", 0.0, "none"));
}

#[test]
fn a_sequence_keeps_the_first_frames_overscan_and_goes_on_where_it_ended() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    frame(&path("s.1.exr"), DISPLAY, DATA, 50.0);
    // Less on the left and at the bottom: nothing is seen there. More on the right: passed over.
    frame(&path("s.2.exr"), DISPLAY, [DATA[0] + 2, DATA[1], DATA[2] + 3, DATA[3] - 1], 50.0);
    frame(&path("later.exr"), DISPLAY, DATA, 50.0);
    let keys = [&view(6.0, [0.5; 2], [0.5; 2])[..3], &keys(&["time.fps=4"])].concat();
    run(folder.path(), "s.#.exr", "grown", &keys);
    std::fs::rename(path("later.exr"), path("s.3.exr")).unwrap();
    let fresh = run(folder.path(), "s.#.exr", "fresh", &keys);
    let grown = {
        let out = folder.path().join("grown");
        let sets = keys.iter().flat_map(|key| ["--set", key]);
        let output = Command::new(env!("CARGO_BIN_EXE_sungaze"))
            .args(["run", "--quiet", "--white", "200000", "--resume", "--out"])
            .args([out.as_os_str(), path("s.#.exr").as_os_str()])
            .args(sets)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        out
    };
    for name in ["seen.0003.exr", "display.0003.png", "probes.csv", "trace.csv", "state.exr"] {
        let bytes = |out: &Path| std::fs::read(out.join(name)).unwrap();
        assert!(bytes(&grown) == bytes(&fresh), "{name}");
    }
    let options = ReadOptions { overscan: Overscan::OfFirst, ..ReadOptions::default() };
    let footage = open(&[path("s.1.exr"), path("s.2.exr")], &options).unwrap();
    assert_eq!(footage.window(), Window { corner: [6, 4], size: [12, 8] });
    let planes = footage.read(1, None, None).unwrap().planes;
    assert_eq!((planes.width, planes.height), (24, 16));
    let red = |x: usize, y: usize| planes.at(x, y, 0) as f32;
    assert_eq!([red(1, 5), red(5, 15)], [0.0; 2], "the second frame has no data there");
    assert_eq!(red(2, 5), f16::from_f32(light(2, 5, 2, 0.0)).to_f32());
}

/// OpenEXR's readers leave pixels without data black.
#[test]
fn a_display_window_beyond_the_data_is_dark_there() {
    let folder = tempfile::tempdir().unwrap();
    // Data begin in the display window's middle and go on beyond its lower right corner.
    let (display, data) = ([0, 0, 11, 7], [6, 4, 20, 9]);
    let path = frame(&folder.path().join("a.exr"), display, data, 0.0);
    let options = ReadOptions { overscan: Overscan::OfFirst, ..ReadOptions::default() };
    let footage = open(std::slice::from_ref(&path), &options).unwrap();
    assert_eq!(footage.window(), Window { corner: [0, 0], size: [12, 8] });
    let planes = footage.read(0, None, None).unwrap().planes;
    assert_eq!((planes.width, planes.height), (21, 10));
    for (x, y) in [(0, 0), (5, 9), (20, 3), (6, 3)] {
        assert_eq!(planes.at(x, y, 1), 0.0, "{x} {y}");
    }
    let expected = f16::from_f32(light(20 - DATA[0], 9 - DATA[1], 2, 0.0)).to_f32();
    assert_eq!(planes.at(20, 9, 0) as f32, expected);
    // Without overscan the picture is the display window.
    let footage = open(&[path], &ReadOptions::default()).unwrap();
    assert_eq!((footage.header().width, footage.header().height), (12, 8));
}

#[test]
fn a_data_window_that_does_not_meet_the_display_is_no_overscan() {
    let folder = tempfile::tempdir().unwrap();
    let far = frame(&folder.path().join("far.exr"), [1_000_000, 0, 1_000_007, 7], DATA, 0.0);
    let options = ReadOptions { overscan: Overscan::OfFirst, ..ReadOptions::default() };
    let footage = open(&[far], &options).unwrap();
    assert_eq!(footage.window(), Window::whole([8, 8]));
    assert_eq!(footage.read(0, None, None).unwrap().planes.at(3, 3, 0), 0.0);
}

#[test]
fn a_frame_is_as_large_as_what_is_shown_of_it_and_its_ranges_are_of_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = frame(&folder.path().join("a.exr"), DISPLAY, DATA, 100.0);
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    let told = command.args(["inspect", "--json"]).arg(&path).output().unwrap();
    let told: serde_json::Value = serde_json::from_slice(&told.stdout).unwrap();
    let told = if told.is_array() { told[0].clone() } else { told };
    assert_eq!((told["width"].as_u64(), told["height"].as_u64()), (Some(12), Some(8)), "{told}");
    let lamp = light(0, 0, 1, 100.0);
    assert!(told["ranges"][1][1].as_f64().unwrap() >= f64::from(lamp) - 0.1, "{told}");
}
