//! Files that other programs made, run whole.

use std::path::{Path, PathBuf};
use std::process::Command;

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// Runs one file for 0.04 s and gives the rows of `probes.csv` as numbers from `I_L` on.
fn run(name: &str, keys: &str) -> Vec<Vec<f64>> {
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("c.toml");
    let frames = sample(name).display().to_string();
    std::fs::write(
        &config,
        format!("input.frames = {frames:?}\ninput.horizontal_fov_deg = 20\ntime.duration_s = 0.04\n{keys}"),
    )
    .unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_sungaze"))
        .args(["run", "--quiet", "--out"])
        .arg(folder.path().join("o"))
        .arg(&config)
        .output()
        .unwrap();
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    let rows = std::fs::read_to_string(folder.path().join("o/probes.csv")).unwrap();
    rows.lines()
        .skip(1)
        .map(|row| row.split(',').skip(3).map(|cell| cell.parse().unwrap()).collect())
        .collect()
}

/// A probe in the middle of each pixel of the top `rows` of a picture.
fn probes(width: usize, height: usize, rows: usize) -> String {
    let probe = |x: usize, y: usize| {
        let at = [(x as f64 + 0.5) / width as f64, (y as f64 + 0.5) / height as f64];
        format!("[[output.probe]]\nname = \"{x} {y}\"\nat = {at:?}\n")
    };
    (0..rows).flat_map(|y| (0..width).map(move |x| probe(x, y))).collect()
}

fn mean(rows: &[Vec<f64>], column: usize) -> f64 {
    rows.iter().map(|row| row[column]).sum::<f64>() / rows.len() as f64
}

#[test]
fn thirty_one_bands_and_four_of_mitsubas_specfilm_give_the_same_trolands() {
    let keys = "input.channels = \"band_{index}\"\ninput.bands_nm = { from = 395, to = 705 }\n\
                input.quantity = \"band-integral\"\nobserver.pupil = \"fixed\"\nobserver.pupil_mm = 3\n";
    let [fine, coarse] = ["mi_scalar_spectral_const_n31.exr", "mi_scalar_spectral_const_n4.exr"]
        .map(|name| run(name, &format!("{keys}{}", probes(16, 16, 4))));
    for cone in 0..3 {
        let (a, b) = (mean(&fine, cone), mean(&coarse, cone));
        assert!((a / b - 1.0).abs() < 0.01, "cone {cone}: {a} td from 31 bands, {b} td from 4");
    }
}

#[test]
fn layouts_of_mitsuba_and_pbrt_need_no_key_but_a_scale() {
    assert!(run("mi_bitmap_fichet.exr", "")[0][0] > 1e4);
    let [one, scaled] = ["", "input.scale = 0.01\nobserver.pupil = \"watson-yellott\"\n"]
        .map(|keys| run("pbrt_like_spectralfilm.exr", keys));
    assert!(
        scaled[0][0] < one[0][0] && scaled[0][7] > 0.0,
        "less light, a wider pupil, the same layout"
    );
    assert!(
        (scaled[0][7] / one[0][7] - 0.01).abs() < 0.002,
        "Y scales: {} {}",
        scaled[0][7],
        one[0][7]
    );
}

#[test]
fn every_spelling_of_a_wavelength_is_read() {
    let [fichet, pbrt] = ["names_fichet6.exr", "names_pbrt3.exr"].map(|name| run(name, ""));
    assert_eq!(fichet, pbrt, "1000 nm of light each, spelled with six digits and with three");
    // Ones at 0.5 um, 6e-7 m and 749.48 THz: light from 350 to 650 nm, white but for its red end.
    let [x, y] = [9, 10].map(|column| run("names_units.exr", "")[0][column]);
    assert!((x - 0.3245).abs() < 1e-3 && (y - 0.3320).abs() < 1e-3, "x {x}, y {y}");
}
