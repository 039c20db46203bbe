//! Frames made for a display: PNG and JPEG.

use std::path::{Path, PathBuf};

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use sungaze::colour::Primaries;
use sungaze::frames::{Footage, Header, Kind, ReadOptions, Transfer, Wanted, open, write_png};
use sungaze::light::Frame;

fn opened(path: &Path, options: &ReadOptions) -> Box<dyn Footage> {
    open(&[path.to_owned()], options).unwrap_or_else(|error| panic!("{error}"))
}

fn header(path: &Path) -> Header {
    opened(path, &ReadOptions::default()).header().clone()
}

fn read(path: &Path) -> Frame {
    opened(path, &ReadOptions::default()).read(0, None, None).unwrap_or_else(|e| panic!("{e}"))
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

/// A PNG of one grey code in 16 bits, 4 x 2 pixels of RGB, with side chunks.
fn png(folder: &tempfile::TempDir, code: u16, chunks: &[(&[u8; 4], &[u8])]) -> PathBuf {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 4, 2);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Sixteen);
    let mut writer = encoder.write_header().unwrap();
    for (name, data) in chunks {
        writer.write_chunk(png::chunk::ChunkType(**name), data).unwrap();
    }
    writer.write_image_data(&code.to_be_bytes().repeat(24)).unwrap();
    writer.finish().unwrap();
    saved(folder, "a.png", &bytes)
}

/// A JPEG of three colours in stripes, red on the left.
fn jpeg(
    folder: &tempfile::TempDir,
    name: &str,
    with: impl Fn(&mut Encoder<&mut Vec<u8>>),
) -> PathBuf {
    let pixel = |x: usize| match x / 16 {
        0 => [230, 20, 20],
        1 => [20, 230, 20],
        _ => [20, 20, 230],
    };
    let pixels: Vec<u8> = (0..48 * 32).flat_map(|i| pixel(i % 48)).collect();
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, 95);
    with(&mut encoder);
    encoder.encode(&pixels, 48, 32, ColorType::Rgb).unwrap();
    saved(folder, name, &bytes)
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
    let value = read(&png(&folder, 1, &[])).planes.at(0, 0, 1);
    assert!((value - 1.0 / 65535.0 / 12.92).abs() < 1e-9);
    assert_eq!(read(&png(&folder, 65535, &[])).tally.clipped, 24);
}

#[test]
fn what_codes_mean_is_told_by_cicp_before_srgb_before_gama() {
    let folder = tempfile::tempdir().unwrap();
    let linear = (b"gAMA", &100_000u32.to_be_bytes()[..]);
    let half = png(&folder, 32768, &[linear]);
    assert!((read(&half).planes.at(1, 1, 0) - 0.5).abs() < 1e-5);
    assert!(header(&half).notes[0].contains("linear"));
    let srgb = 32768.0 / 65535.0;
    let srgb = ((srgb + 0.055f64) / 1.055).powf(2.4);
    for chunks in
        [vec![(b"gAMA", &45_455u32.to_be_bytes()[..])], vec![(b"sRGB", &[0][..]), linear], vec![]]
    {
        let value = read(&png(&folder, 32768, &chunks)).planes.at(1, 1, 0);
        assert!((value - srgb).abs() < 1e-6, "{value}");
    }
    let pq = png(&folder, 49151, &[(b"cICP", &[9, 16, 0, 1])]);
    // ST 2084: a signal of 0.75 is 983.4 cd/m2.
    assert!((read(&pq).planes.at(1, 1, 0) / 983.4 - 1.0).abs() < 1e-3);
    let header = header(&pq);
    assert_eq!(header.white.map(|white| white.0), Some(1.0));
    let Kind::Rgb(primaries) = header.kind else { panic!("not RGB") };
    assert_eq!(primaries.green, [0.17, 0.797]);
}

#[test]
fn hlg_needs_a_peak_and_a_curve_of_the_configuration_goes_before_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = png(&folder, 49151, &[(b"cICP", &[9, 18, 0, 1])]);
    assert_eq!(header(&path).white, None);
    let options = ReadOptions { peak_cd_m2: Some(1000.0), ..ReadOptions::default() };
    let footage = opened(&path, &options);
    let white = footage.header().white.unwrap().0;
    let value = footage.read(0, None, None).unwrap().planes.at(0, 0, 1) * white;
    assert!((value / 203.0 - 1.0).abs() < 5e-3, "{value}");
    let options = ReadOptions { transfer: Some(Transfer::Linear), ..options };
    let value = opened(&path, &options).read(0, None, None).unwrap().planes.at(0, 0, 1);
    assert!((value - 0.75).abs() < 1e-4, "{value}");
}

#[test]
fn chromaticities_of_a_png_are_its_primaries() {
    let folder = tempfile::tempdir().unwrap();
    let points = [31270u32, 32900, 68000, 32000, 26500, 69000, 15000, 6000];
    let chunk = points.map(u32::to_be_bytes).concat();
    let Kind::Rgb(primaries) = header(&png(&folder, 9, &[(b"cHRM", &chunk)])).kind else {
        panic!("not RGB")
    };
    assert_eq!((primaries.white, primaries.red), ([0.3127, 0.329], [0.68, 0.32]));
}

/// 332 bytes hold a black frame of one bit a pixel; the same bytes hold no frame of 16 bits.
#[test]
fn a_black_picture_of_one_bit_is_no_bomb() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1920, 1080);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_compression(png::Compression::High);
    encoder.write_header().unwrap().write_image_data(&vec![0; 240 * 1080]).unwrap();
    assert!(bytes.len() < 1500, "{}", bytes.len());
    assert_eq!(read(&saved(&folder, "a.png", &bytes)).planes.at(7, 9, 1), 0.0);
}

#[test]
fn a_profile_is_told_and_its_size_is_bounded() {
    let folder = tempfile::tempdir().unwrap();
    let path = jpeg(&folder, "a.jpg", |encoder| encoder.add_icc_profile(&[7; 400]).unwrap());
    assert!(header(&path).notes.join(" ").contains("ICC profile is passed over"));
}

#[test]
fn jpeg_is_read_and_a_cut_one_refused_wherever_it_was_cut() {
    let folder = tempfile::tempdir().unwrap();
    for progressive in [false, true] {
        let path = jpeg(&folder, "a.jpg", |encoder| {
            encoder.set_progressive(progressive);
            encoder.set_sampling_factor(SamplingFactor::F_2_2);
        });
        let planes = read(&path).planes;
        for stripe in 0..3 {
            let light = [0, 1, 2].map(|plane| planes.at(stripe * 16 + 8, 9, plane));
            let expected = [0, 1, 2].map(|plane| if plane == stripe { 0.791 } else { 0.007 });
            let near = light.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.03);
            assert!(near, "{light:?} {expected:?}");
        }
        let bytes = std::fs::read(&path).unwrap();
        for percent in [3, 30, 60, 90, 99] {
            let cut = saved(&folder, "cut.jpg", &bytes[..bytes.len() * percent / 100]);
            let message = refused(&cut, &ReadOptions::default());
            assert!(message.contains("cut.jpg: is damaged or cut short"), "{message}");
        }
    }
    let spectral = ReadOptions { wanted: Wanted::Spectral, ..Default::default() };
    assert!(refused(&folder.path().join("a.jpg"), &spectral).contains("spectral"));
}

#[test]
fn colours_in_scans_of_their_own_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = jpeg(&folder, "a.jpg", |encoder| {
        encoder.set_sampling_factor(SamplingFactor::F_2_2);
    });
    let mut bytes = std::fs::read(&path).unwrap();
    let scan = bytes.windows(2).position(|pair| pair == [0xff, 0xda]).unwrap();
    bytes[scan + 4] = 1;
    let message = refused(&saved(&folder, "b.jpg", &bytes), &ReadOptions::default());
    assert!(message.contains("scans of their own"), "{message}");
}

#[test]
fn a_jpeg_on_its_side_is_turned() {
    let folder = tempfile::tempdir().unwrap();
    let exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0";
    let path = jpeg(&folder, "a.jpg", |encoder| encoder.add_app_segment(1, exif.to_vec()).unwrap());
    let frame = read(&path).planes;
    assert_eq!((frame.width, frame.height), (32, 48));
    let red_above_blue = frame.at(16, 8, 0) > 0.5 && frame.at(16, 40, 2) > 0.5;
    assert!(red_above_blue, "orientation 6: the left of the file is the top of the picture");
}

#[cfg(unix)]
#[test]
fn a_file_without_end_is_not_read_whole() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.jpg", "a.png", "a.hdr"] {
        let path = folder.path().join(name);
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        assert!(refused(&path, &ReadOptions::default()).contains(name));
    }
}
