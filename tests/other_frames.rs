//! Frames that are not OpenEXR: Radiance, PNG and JPEG, ENVI.

use std::path::{Path, PathBuf};

use sungaze::colour::Primaries;
use sungaze::frames::{Footage, Kind, Negative, Quantity, ReadOptions, Wanted, open, write_png};
use sungaze::light::Frame;

fn opened(path: &Path, options: &ReadOptions) -> Box<dyn Footage> {
    open(&[path.to_owned()], options).unwrap_or_else(|error| panic!("{error}"))
}

fn read(path: &Path) -> Frame {
    opened(path, &ReadOptions::default())
        .read(0, None, None)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn refused(path: &Path, options: &ReadOptions) -> String {
    let read = open(&[path.to_owned()], options).and_then(|footage| footage.read(0, None, None));
    read.map(|_| ()).expect_err("should be refused").to_string()
}

fn saved(folder: &tempfile::TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// A Radiance file of flat pixels with these header lines.
fn radiance(lines: &str, resolution: &str, pixels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n{lines}\n{resolution}\n").into_bytes();
    bytes.extend(pixels.iter().flatten());
    bytes
}

/// Mantissas under the exponent of 1.0: 128 is 0.5.
const HALF: [u8; 4] = [128, 64, 32, 128];

#[test]
fn radiance_is_divided_by_every_exposure_and_colour_correction() {
    let folder = tempfile::tempdir().unwrap();
    let lines = "FORMAT=32-bit_rle_rgbe\nEXPOSURE=2\nEXPOSURE= 0.25\nCOLORCORR=1 2 4\nPRIMARIES=.7 .3 .2 .7 .1 .1 .3 .3\n";
    let path = saved(&folder, "a.hdr", &radiance(lines, "-Y 1 +X 1", &[HALF]));
    let planes = read(&path).planes;
    assert_eq!([0, 1, 2].map(|i| planes.at(0, 0, i)), [1.0, 0.25, 0.0625]);
    let Kind::Rgb(primaries) = opened(&path, &ReadOptions::default()).header().kind else {
        panic!("not RGB")
    };
    assert_eq!((primaries.red, primaries.white), ([0.7, 0.3], [0.3, 0.3]));
}

#[test]
fn xyz_of_the_white_point_is_white() {
    let folder = tempfile::tempdir().unwrap();
    // D65: X 0.9505, Y 1, Z 1.0891.
    let white = [122, 128, 139, 129];
    let path =
        saved(&folder, "a.hdr", &radiance("FORMAT=32-bit_rle_xyze\n", "-Y 1 +X 1", &[white]));
    let planes = read(&path).planes;
    let rgb = [0, 1, 2].map(|i| planes.at(0, 0, i));
    assert!(rgb.iter().all(|value| (value - 1.0).abs() < 0.02), "{rgb:?}");
}

#[test]
fn rows_from_the_bottom_and_columns_from_the_right_are_turned() {
    let folder = tempfile::tempdir().unwrap();
    let pixel = |value| [value, value, value, 128];
    let pixels = [pixel(128), pixel(64), pixel(32), pixel(16)];
    let value = |resolution: &str, x, y| {
        let path =
            saved(&folder, "a.hdr", &radiance("FORMAT=32-bit_rle_rgbe\n", resolution, &pixels));
        read(&path).planes.at(x, y, 0)
    };
    assert_eq!(value("-Y 2 +X 2", 1, 0), 0.25);
    assert_eq!(value("+Y 2 +X 2", 1, 0), 0.0625);
    assert_eq!(value("-Y 2 -X 2", 1, 0), 0.5);
}

#[test]
fn a_broken_radiance_file_is_named_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let good = radiance("FORMAT=32-bit_rle_rgbe\n", "-Y 2 +X 2", &[HALF; 4]);
    let text = String::from_utf8_lossy(&good[..good.len() - 16]).into_owned();
    for (bytes, expected) in [
        (good[..good.len() - 1].to_vec(), "cut short"),
        (good[..20].to_vec(), "cut short inside its header"),
        (text.replace("rgbe", "tiff").into_bytes(), "32-bit_rle_xyze"),
        (text.replace("FORMAT", "EXPOSURE=0\nFORMAT").into_bytes(), "cannot be divided by"),
        (text.replace("+X 2", "+X 70000").replace("-Y 2", "-Y 70000").into_bytes(), "max_pixels"),
        (text.replace("+X 2", "+X 9000").replace("-Y 2", "-Y 9000").into_bytes(), "in a file of"),
        (text.replace("-Y 2 +X 2", "+X 2 -Y 2").into_bytes(), "resolution line"),
        (b"JFIF\n".to_vec(), "does not begin with #?"),
    ] {
        let message = refused(&saved(&folder, "a.hdr", &bytes), &ReadOptions::default());
        assert!(message.contains("a.hdr") && message.contains(expected), "{message}");
    }
}

#[test]
fn png_is_decoded_to_linear_light_and_its_clipped_sun_is_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    write_png(&path, 2, 1, &[255, 0, 188, 255, 255, 10]).unwrap();
    let footage = opened(&path, &ReadOptions::default());
    assert_eq!(footage.header().kind, Kind::Rgb(Primaries::REC709));
    assert!(footage.header().notes[0].contains("sun"), "{:?}", footage.header().notes);
    let frame = footage.read(0, None, None).unwrap();
    assert_eq!(frame.tally.clipped, 3);
    assert_eq!((frame.planes.at(0, 0, 0), frame.planes.at(0, 0, 1)), (1.0, 0.0));
    assert!((frame.planes.at(0, 0, 2) - 0.5029).abs() < 1e-4, "{}", frame.planes.at(0, 0, 2));
    assert!((frame.planes.at(1, 0, 2) - 10.0 / 255.0 / 12.92).abs() < 1e-7);
}

#[test]
fn sixteen_bits_keep_their_depth() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    image::ImageBuffer::<image::Rgb<u16>, _>::from_raw(1, 1, vec![65535u16, 1, 40000])
        .unwrap()
        .save(&path)
        .unwrap();
    let frame = read(&path);
    assert_eq!(frame.tally.clipped, 1);
    assert!((frame.planes.at(0, 0, 1) - 1.0 / 65535.0 / 12.92).abs() < 1e-9);
}

#[test]
fn jpeg_is_read_and_a_cut_one_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jpg");
    image::RgbImage::from_pixel(16, 16, image::Rgb([200, 200, 200])).save(&path).unwrap();
    assert!((read(&path).planes.at(5, 5, 1) - 0.578).abs() < 0.01);
    let bytes = std::fs::read(&path).unwrap();
    let cut = saved(&folder, "cut.jpg", &bytes[..30]);
    assert!(refused(&cut, &ReadOptions::default()).contains("cut.jpg: is damaged or cut short"));
    assert!(
        refused(&path, &ReadOptions { wanted: Wanted::Spectral, ..Default::default() })
            .contains("spectral")
    );
}

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

#[test]
fn the_file_of_spectral_python_has_its_bands_by_header_or_data() {
    for name in ["envi_bsq.hdr", "envi_bsq.img"] {
        let footage = opened(&sample(name), &ReadOptions::default());
        let Kind::Spectral(bands) = &footage.header().kind else { panic!("not spectral") };
        assert_eq!(
            (bands.len(), bands.as_slice()[0].centre, bands.as_slice()[30].centre),
            (31, 400.0, 700.0)
        );
        assert_eq!((footage.header().width, footage.header().height), (8, 6));
        let raw = std::fs::read(sample("envi_bsq.img")).unwrap();
        let value = |band: usize, y: usize, x: usize| {
            f64::from(f32::from_le_bytes(
                raw[((band * 6 + y) * 8 + x) * 4..][..4].try_into().unwrap(),
            ))
        };
        let planes = footage.read(0, None, None).unwrap().planes;
        assert_eq!([planes.at(3, 2, 7), planes.at(7, 5, 30)], [value(7, 2, 3), value(30, 5, 7)]);
    }
}

/// A 3 x 2 picture of two bands at 700 and 500 nm whose samples are 100 band + 10 y + x.
fn envi(folder: &tempfile::TempDir, interleave: &str, code: u8, big: bool, more: &str) -> PathBuf {
    let order = u8::from(big);
    let header = format!(
        "ENVI\nsamples = 3\nlines = 2\nbands = 2\nheader offset = 5\ndata type = {code}\ninterleave = {interleave}\n\
         byte order = {order}\nwavelength units = nm\nwavelength = {{700, 500}}\n{more}"
    );
    let place = |i: usize| match interleave {
        "bsq" => (i / 6, i / 3 % 2, i % 3),
        "bil" => (i / 3 % 2, i / 6, i % 3),
        _ => (i % 2, i / 6, i / 2 % 3),
    };
    let mut data = vec![9; 5];
    for (band, y, x) in (0..12).map(place) {
        let value = (100 * band + 10 * y + x) as i16;
        let mut bytes = match code {
            4 => f32::from(value).to_le_bytes().to_vec(),
            5 => f64::from(value).to_le_bytes().to_vec(),
            _ => value.to_le_bytes().to_vec(),
        };
        if big {
            bytes.reverse();
        }
        data.extend(bytes);
    }
    saved(folder, "a.raw", &data);
    saved(folder, "a.hdr", header.as_bytes())
}

#[test]
fn every_envi_layout_holds_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    for interleave in ["bsq", "bil", "bip"] {
        for (code, big) in [2, 4, 5, 12].into_iter().flat_map(|code| [(code, false), (code, true)])
        {
            let planes = read(&envi(&folder, interleave, code, big, "")).planes;
            for (x, y, plane) in [(0, 0, 0), (2, 1, 0), (1, 0, 1), (2, 1, 1)] {
                let expected = (100 * (1 - plane) + 10 * y + x) as f64;
                assert_eq!(planes.at(x, y, plane), expected, "{interleave} {code} {big}");
            }
        }
    }
}

#[test]
fn envi_scale_factor_ignored_value_and_width_are_heeded() {
    let folder = tempfile::tempdir().unwrap();
    let more = "reflectance scale factor = 10\ndata ignore value = 111\nfwhm = {4, 5}\n";
    let path = envi(&folder, "bil", 4, false, more);
    let options =
        ReadOptions { scale: 2.0, quantity: Quantity::BandIntegral, ..ReadOptions::default() };
    let planes = opened(&path, &options).read(0, None, None).unwrap().planes;
    assert!((planes.at(2, 1, 1) - 12.0 * 2.0 / 10.0 / 4.0).abs() < 1e-6, "{}", planes.at(2, 1, 1));
    assert!((planes.at(0, 0, 0) - 100.0 * 2.0 / 10.0 / 5.0).abs() < 1e-6, "{}", planes.at(0, 0, 0));
    assert_eq!(planes.at(1, 1, 0), 0.0);
}

#[test]
fn an_envi_file_without_its_other_half_or_too_short_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = envi(&folder, "bsq", 4, false, "");
    saved(&folder, "a.raw", &[0; 52]);
    assert!(
        refused(&path, &ReadOptions::default())
            .contains("a.raw: is cut short: 52 bytes do not hold 3 x 2 x 2")
    );
    std::fs::remove_file(folder.path().join("a.raw")).unwrap();
    assert!(refused(&path, &ReadOptions::default()).contains("has no data beside it; looked for"));
}

#[test]
fn negative_envi_samples_are_counted_and_clamped() {
    let folder = tempfile::tempdir().unwrap();
    let path = envi(&folder, "bip", 2, false, "");
    let mut data = std::fs::read(folder.path().join("a.raw")).unwrap();
    data[5..7].copy_from_slice(&(-5i16).to_le_bytes());
    saved(&folder, "a.raw", &data);
    let options = ReadOptions { negative: Negative::Clamp, ..ReadOptions::default() };
    let frame = opened(&path, &options).read(0, None, None).unwrap();
    assert_eq!((frame.tally.negative, frame.planes.at(0, 0, 1)), (1, 0.0));
}
