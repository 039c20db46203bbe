//! What comes out agrees with the world: one colour space in tables and pictures, and a display
//! that grows darker as what is seen does.

use std::path::Path;
use std::process::Command;

use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};

/// Linear sRGB -> CIE XYZ (IEC 61966-2-1, by its primaries and white, to seven digits).
const SRGB_TO_XYZ: [[f64; 3]; 3] = [
    [0.412_390_8, 0.357_584_3, 0.180_480_8],
    [0.212_639_0, 0.715_168_7, 0.072_192_3],
    [0.019_330_8, 0.119_194_8, 0.950_532_2],
];

fn run(folder: &Path, keys: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    command.current_dir(folder).args(["run", "--out", "o", "--quiet"]);
    let out = command.args(keys.iter().flat_map(|key| ["--set", key])).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
}

/// The columns of `probes.csv` by name, row by row.
fn probes(folder: &Path, names: &[&str]) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(folder.join("o/probes.csv")).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let columns: Vec<usize> =
        names.iter().map(|name| header.iter().position(|h| h == name).unwrap()).collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        columns.iter().map(|i| cells[*i].parse().unwrap()).collect()
    };
    lines.map(row).collect()
}

/// R, G, B of a pixel of a picture of floats.
fn pixel(path: &Path, [x, y]: [usize; 2]) -> [f64; 3] {
    let image = read_first_flat_layer_from_file(path).unwrap();
    let width = image.layer_data.size.x();
    ["R", "G", "B"].map(|name| {
        let channels = &image.layer_data.channel_data.list;
        let channel = channels.iter().find(|channel| channel.name.eq(name)).unwrap();
        let FlatSamples::F32(samples) = &channel.sample_data else { panic!("not of floats") };
        f64::from(samples[y * width + x])
    })
}

/// The first pixel of an RGB picture of 8 bits.
fn first_pixel(path: &Path) -> [u8; 3] {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut png = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; png.output_buffer_size().unwrap()];
    png.next_frame(&mut bytes).unwrap();
    [bytes[0], bytes[1], bytes[2]]
}

fn times(matrix: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[test]
fn the_xyz_of_a_probe_is_the_standard_matrix_times_the_pixel_of_what_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let keys = ["input.width=96", "time.times_s=[0, 0.5, 2, 9, 40]"];
    run(folder.path(), &keys);
    let rows = probes(folder.path(), &["X", "Y", "Z"]);
    assert_eq!(rows.len(), 4);
    for (i, row) in rows.iter().enumerate() {
        let seen = folder.path().join(format!("o/seen.{:04}.exr", i + 1));
        let pixel = pixel(&seen, [48, 27]);
        let expected = times(SRGB_TO_XYZ, pixel);
        // What single precision leaves of a sum is relative to its terms.
        let terms = times(SRGB_TO_XYZ, pixel.map(f64::abs));
        for k in 0..3 {
            let error = (row[k] - expected[k]).abs() / terms[k];
            assert!(error < 1e-6, "frame {}: {row:?} and {expected:?}", i + 1);
        }
    }
}

#[test]
fn a_coloured_field_is_displayed_ever_darker_and_never_black() {
    let folder = tempfile::tempdir().unwrap();
    run(
        folder.path(),
        &[
            "input.scene=field",
            "input.level=1e6",
            "input.unit=cd_m2",
            "input.spectrum=d65",
            "time.times_s=[0, 0.1, 0.3, 1, 2, 3, 5, 20, 60]",
        ],
    );
    let mut before = [f64::INFINITY; 2];
    for (i, row) in probes(folder.path(), &["Y"]).iter().enumerate() {
        let path = folder.path().join(format!("o/display.{:04}.png", i + 1));
        let shown = first_pixel(&path);
        let linear = shown.map(|code| {
            let v = f64::from(code) / 255.0;
            if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        });
        let luminance = times(SRGB_TO_XYZ, linear)[1];
        assert!(shown.iter().any(|code| *code > 0), "frame {}: {shown:?}", i + 1);
        // What falls by less than a hundredth may share a code.
        if row[0] < 0.99 * before[0] {
            assert!(luminance < before[1], "frame {}: {luminance} after {}", i + 1, before[1]);
        }
        before = [row[0], luminance];
    }
}
