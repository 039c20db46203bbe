//! What `inspect` tells of files.

use std::path::{Path, PathBuf};

use sungaze::frames::{
    About, Compression, Header, Inspection, Kind, ReadOptions, inspect, write_exr,
};
use sungaze::light::{Planes, Samples};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Weights as if every plane gave one cd/m2.
fn ones(header: &Header) -> Option<Vec<f64>> {
    match &header.kind {
        Kind::Rgb(_) => header.white.map(|white| vec![white.0 / 3.0; 3]),
        Kind::Spectral(bands) => Some(vec![1.0; bands.len()]),
    }
}

fn inspected(path: &Path) -> Inspection {
    inspect(path, &ReadOptions::default(), &ones).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_sample_file_is_described_without_a_key() {
    // Width, height, bands (0: RGB or still to be named) and channels.
    let files = [
        ("tests/data/mi_bitmap_fichet.exr", [5, 4, 31, 31]),
        ("tests/data/mi_scalar_spectral_const_n31.exr", [16, 16, 0, 0]),
        ("tests/data/mi_scalar_spectral_const_n4.exr", [16, 16, 0, 0]),
        ("tests/data/names_fichet6.exr", [6, 4, 3, 3]),
        ("tests/data/names_pbrt3.exr", [6, 4, 3, 3]),
        ("tests/data/names_units.exr", [6, 4, 3, 3]),
        ("tests/data/pbrt_like_spectralfilm.exr", [64, 48, 16, 16]),
        ("tests/data/envi_bsq.hdr", [8, 6, 31, 31]),
        ("data/panorama_sky.exr", [512, 256, 0, 3]),
        ("data/headlamps.hdr", [480, 270, 0, 3]),
    ];
    for (name, expected) in files {
        let found = inspected(&data(name));
        let bands = found.bands_nm.as_ref().map_or(0, Vec::len);
        assert_eq!([found.width, found.height, bands, found.ranges.len()], expected, "{name}");
        let size = format!("{} x {} pixels", expected[0], expected[1]);
        assert!(found.to_string().contains(&size), "{name}: {found}");
    }
}

#[test]
fn a_file_with_free_names_is_described_by_its_channels_and_the_key_it_needs() {
    let inspection = inspected(&data("tests/data/mi_scalar_spectral_const_n4.exr"));
    assert_eq!(inspection.kind, None);
    assert_eq!(inspection.exr.as_ref().unwrap().channels.len(), 4);
    assert!(inspection.to_string().contains("channels = \"S0_{nm}nm\""), "{inspection}");
}

#[test]
fn the_sunset_has_its_bands_windows_and_brightest_band() {
    let inspection = inspected(&data("data/sunset_mitsuba.exr"));
    let bands = inspection.bands_nm.as_ref().unwrap();
    assert_eq!(
        (bands.len(), bands[0], bands[30]),
        (31, [400.0, 395.0, 405.0], [700.0, 695.0, 705.0])
    );
    assert_eq!(
        (inspection.width, inspection.height, inspection.nan, inspection.infinite),
        (480, 270, 0, 0)
    );
    let largest = |i: usize| inspection.ranges[i][1];
    assert!(largest(30) > 10.0 * largest(0), "a low sun is red");
    let [low, high] = inspection.luminance_cd_m2.unwrap();
    assert!(low > 0.0 && high > largest(30));
}

#[test]
fn flaws_are_counted_and_never_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flawed.exr");
    let samples = vec![1.0, f32::NAN, f32::INFINITY, -2.0, 4.0, 0.5];
    let planes = Planes { width: 2, height: 1, count: 3, samples: Samples::Float(samples) };
    let about = About { white: Some(sungaze::units::Nits(300.0)), ..About::default() };
    write_exr(&path, &["R", "G", "B"], &planes, Compression::Zip, &about).unwrap();
    let inspection = inspected(&path);
    assert_eq!((inspection.nan, inspection.infinite, inspection.negative), (1, 1, 1));
    assert_eq!(inspection.ranges, [[0.0, 1.0], [-2.0, 4.0], [0.5, 4.0]]);
    assert_eq!(inspection.luminance_cd_m2, Some([-150.0, 900.0]));
    assert_eq!(inspection.exr.unwrap().attributes["whiteLuminance"], "300");
}
