//! Frames that are not OpenEXR: Radiance and ENVI.

use std::path::{Path, PathBuf};

use sungaze::colour::Primaries;
use sungaze::frames::{Footage, Kind, Negative, Quantity, ReadOptions, View, ViewProjection, open};
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

/// Mantissas under the exponent of 1.0: 128 is 128.5 / 256.
const HALF: [u8; 4] = [128, 64, 32, 128];

#[test]
fn radiance_is_divided_by_every_exposure_and_colour_correction() {
    let folder = tempfile::tempdir().unwrap();
    let lines = "FORMAT=32-bit_rle_rgbe\nEXPOSURE=2\nEXPOSURE= 0.25\nCOLORCORR=1 2 4\nPRIMARIES=.7 .3 .2 .7 .1 .1 .3 .3\n";
    let path = saved(&folder, "a.hdr", &radiance(lines, "-Y 1 +X 1", &[HALF]));
    let planes = read(&path).planes;
    let stored = [128.5 / 256.0, 64.5 / 256.0, 32.5 / 256.0];
    assert_eq!(
        [0, 1, 2].map(|i| planes.at(0, 0, i)),
        [stored[0] * 2.0, stored[1], stored[2] / 2.0]
    );
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

fn header_of(folder: &tempfile::TempDir, lines: &str) -> sungaze::frames::Header {
    let path = saved(folder, "a.hdr", &radiance(lines, "-Y 1 +X 1", &[HALF]));
    opened(&path, &ReadOptions::default()).header().clone()
}

#[test]
fn lines_that_begin_with_a_blank_are_the_history_of_another_picture() {
    let folder = tempfile::tempdir().unwrap();
    let lines = "source.hdr:\n\tEXPOSURE=2.5\n\tVIEW= -vtv -vh 60\n SOFTWARE= RADIANCE\n\
                 FORMAT=32-bit_rle_rgbe\n";
    let path = saved(&folder, "a.hdr", &radiance(lines, "-Y 1 +X 1", &[HALF]));
    assert_eq!(read(&path).planes.at(0, 0, 0), 128.5 / 256.0);
    let header = header_of(&folder, lines);
    assert_eq!((header.view, header.white), (None, None));
}

#[test]
fn a_picture_of_radiance_itself_has_its_primaries_its_white_and_its_view() {
    let folder = tempfile::tempdir().unwrap();
    let by_rpict = header_of(
        &folder,
        "rpict -vf a.vf a.oct\nSOFTWARE= RADIANCE 5.4a\nVIEW= -vtv -vp 0 0 1 -vh 60 -vv 40\n",
    );
    let view = View { horizontal_fov_deg: 60.0, projection: ViewProjection::Perspective };
    assert_eq!((by_rpict.view, by_rpict.white.map(|white| white.0)), (Some(view), Some(179.0)));
    let Kind::Rgb(primaries) = by_rpict.kind else { panic!("not RGB") };
    assert_eq!(primaries.green, [0.29, 0.6]);
    let by_camera = header_of(&folder, "VIEW= -vta -vh 180 -vv 180\n");
    assert_eq!(by_camera.kind, Kind::Rgb(Primaries::REC709));
    assert_eq!(by_camera.view.map(|view| view.projection), Some(ViewProjection::Angular));
    assert_eq!(by_camera.white.map(|white| white.0), Some(179.0));
}

#[test]
fn xyz_is_in_cd_m2_and_pixels_that_are_not_square_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let header = header_of(&folder, "FORMAT=32-bit_rle_xyze\nPIXASPECT=2.0\n");
    assert_eq!(header.white.map(|white| white.0), Some(1.0));
    assert!(header.notes.iter().any(|note| note.contains("PIXASPECT 2")), "{:?}", header.notes);
}

/// f = w / 2 / tan(fov / 2) pixels; a degree in the middle is f tan(1 degree), nearly f pi / 180.
#[test]
fn the_middle_of_a_perspective_picture_has_fewer_pixels_to_the_degree() {
    let view = |projection| View { horizontal_fov_deg: 90.0, projection };
    assert_eq!(view(ViewProjection::Angular).pixels_per_degree(180), 2.0);
    let middle = view(ViewProjection::Perspective).pixels_per_degree(180);
    assert!((middle - 90.0 * std::f64::consts::PI / 180.0).abs() < 1e-9, "{middle}");
    let wide = View { horizontal_fov_deg: 180.0, projection: ViewProjection::Perspective };
    assert_eq!(wide.possible(), None);
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
    let stored = |mantissa: f64| (mantissa + 0.5) / 256.0;
    assert_eq!(value("-Y 2 +X 2", 1, 0), stored(64.0));
    assert_eq!(value("+Y 2 +X 2", 1, 0), stored(16.0));
    assert_eq!(value("-Y 2 -X 2", 1, 0), stored(128.0));
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
            3 | 13 => i32::from(value).to_le_bytes().to_vec(),
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
        for (code, big) in
            [2, 3, 4, 5, 12, 13].into_iter().flat_map(|code| [(code, false), (code, true)])
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
fn envi_gain_offset_ignored_value_and_width_are_heeded() {
    let folder = tempfile::tempdir().unwrap();
    let more = "data gain values = {.1, 10}\ndata offset values = {1, 0}\n\
                data ignore value = 111\nfwhm = {4, 5}\n";
    let path = envi(&folder, "bil", 4, false, more);
    let options =
        ReadOptions { scale: 2.0, quantity: Quantity::BandIntegral, ..ReadOptions::default() };
    let planes = opened(&path, &options).read(0, None, None).unwrap().planes;
    assert!((planes.at(2, 1, 1) - (12.0 * 0.1 + 1.0) * 2.0 / 4.0).abs() < 1e-6);
    assert!((planes.at(0, 0, 0) - 100.0 * 10.0 * 2.0 / 5.0).abs() < 1e-3);
    assert_eq!(planes.at(1, 1, 0), 0.0);
}

#[test]
fn reflectance_and_light_that_no_eye_sees_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = envi(&folder, "bil", 4, false, "reflectance scale factor = 10000\n");
    assert!(refused(&path, &ReadOptions::default()).contains("holds reflectances"));
    let path = envi(&folder, "bil", 4, false, "wavelength = {1400, 900}\n");
    assert!(refused(&path, &ReadOptions::default()).contains("holds no visible light"));
    let path = envi(&folder, "bil", 4, false, "wavelength = {700, 640}\n");
    let notes = opened(&path, &ReadOptions::default()).header().notes.join("; ");
    assert!(notes.contains("leave the S cones in the dark"), "{notes}");
}

#[test]
fn a_band_marked_bad_is_left_out_and_the_others_keep_their_places() {
    let folder = tempfile::tempdir().unwrap();
    for interleave in ["bsq", "bil", "bip"] {
        let path = envi(&folder, interleave, 2, false, "bbl = {0, 1}\n");
        let footage = opened(&path, &ReadOptions::default());
        assert!(footage.header().notes.join(" ").contains("marked bad"));
        let planes = footage.read(0, None, None).unwrap().planes;
        assert_eq!((planes.count, planes.at(2, 1, 0)), (1, 112.0), "{interleave}");
    }
}

#[test]
fn texts_of_other_editors_and_countries_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = envi(&folder, "bil", 4, false, "description = {made by X; version 2}\n");
    let text = std::fs::read_to_string(&path).unwrap();
    let microns = text.replace("= nm", "= µm").replace("{700, 500}", "{.7, .5}");
    let latin: Vec<u8> = microns.chars().map(|c| u32::from(c) as u8).collect();
    let marked = [b"\xef\xbb\xbf", text.as_bytes()].concat();
    for bytes in [microns.into_bytes(), latin, marked] {
        std::fs::write(&path, bytes).unwrap();
        let Kind::Spectral(bands) = opened(&path, &ReadOptions::default()).header().kind.clone()
        else {
            panic!("not spectral")
        };
        assert_eq!(bands.as_slice()[0].centre, 500.0);
    }
}

#[test]
fn header_and_data_find_each_other_under_every_name() {
    let folder = tempfile::tempdir().unwrap();
    let (header, data) = (envi(&folder, "bil", 4, false, ""), folder.path().join("a.raw"));
    let (header, data) = (std::fs::read(header).unwrap(), std::fs::read(data).unwrap());
    for (of_header, of_data) in [
        ("CUBE.HDR", "CUBE.IMG"),
        ("b.hdr", "b"),
        ("c.hdr", "c.bin"),
        ("d.xyz.hdr", "d.xyz"),
        ("e.hdr", "e.flt"),
    ] {
        let header = saved(&folder, of_header, &header);
        let data = saved(&folder, of_data, &data);
        assert_eq!(read(&header).planes.at(2, 1, 0), 112.0, "{of_header}");
        assert_eq!(read(&data).planes.at(2, 1, 0), 112.0, "{of_data}");
    }
}

#[test]
fn a_header_closer_to_the_datas_own_name_goes_first() {
    let folder = tempfile::tempdir().unwrap();
    let header = std::fs::read(envi(&folder, "bil", 4, false, "")).unwrap();
    let data = std::fs::read(folder.path().join("a.raw")).unwrap();
    let other = String::from_utf8(header.clone()).unwrap().replace("{700, 500}", "{710, 510}");
    let image = saved(&folder, "x.img", &data);
    saved(&folder, "x.img.hdr", &header);
    saved(&folder, "x.dat", &data);
    let of_dat = saved(&folder, "x.hdr", other.as_bytes());
    let first = |path: &Path| match &opened(path, &ReadOptions::default()).header().kind {
        Kind::Spectral(bands) => bands.as_slice()[0].centre,
        Kind::Rgb(_) => panic!("not spectral"),
    };
    assert_eq!((first(&image), first(&of_dat)), (500.0, 510.0));
}

/// 2^63 + 1 samples in 2 lines are 2 in 64 bits.
#[test]
fn sizes_that_wrap_and_bands_by_the_thousand_are_refused_or_read_in_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = envi(&folder, "bil", 4, false, "samples = 9223372036854775809\n");
    assert!(refused(&path, &ReadOptions::default()).contains("declares"));
    let path = envi(&folder, "bil", 4, false, "samples = 6148914691236517206\nlines = 3\n");
    assert!(refused(&path, &ReadOptions::default()).contains("declares"));
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
