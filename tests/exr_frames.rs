//! OpenEXR files as renderers write them, read and written.

use std::path::{Path, PathBuf};

use half::f16;
use sungaze::colour::Primaries;
use sungaze::frames::{
    About, ChannelNames, Compression, Footage, Header, Kind, Negative, NonFinite, Quantity,
    ReadOptions, Wanted, open, read_exr, write_exr,
};
use sungaze::light::{Frame, Planes, Samples};
use sungaze::units::Nits;
use sungaze::vision::Projection;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn opened(name: &str, options: &ReadOptions) -> Box<dyn Footage> {
    open(&[data(name)], options).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(path: PathBuf, options: &ReadOptions) -> String {
    let read = open(&[path], options).and_then(|footage| footage.read(0, None, None));
    read.map(|_| ()).expect_err("should be refused").to_string()
}

fn bands(header: &Header) -> Vec<(f64, f64)> {
    match &header.kind {
        Kind::Spectral(bands) => {
            bands.as_slice().iter().map(|band| (band.centre, band.width())).collect()
        }
        Kind::Rgb(_) => panic!("not spectral"),
    }
}

/// Mean of the first `rows` rows of every plane.
fn top_means(frame: &Frame, rows: usize) -> Vec<f64> {
    let planes = &frame.planes;
    let mean = |i| {
        let sum: f64 =
            (0..rows).flat_map(|y| (0..planes.width).map(move |x| planes.at(x, y, i))).sum();
        sum / (rows * planes.width) as f64
    };
    (0..planes.count).map(mean).collect()
}

fn constant_sky(name: &str) -> Box<dyn Footage> {
    let channels = ChannelNames::Index { pattern: "band_{index}".into(), from: 395.0, to: 705.0 };
    opened(
        name,
        &ReadOptions { channels, quantity: Quantity::BandIntegral, ..ReadOptions::default() },
    )
}

#[test]
fn the_constant_sky_of_mitsuba_is_one_watt_in_31_bands_and_in_4() {
    for (name, count) in
        [("mi_scalar_spectral_const_n31.exr", 31), ("mi_scalar_spectral_const_n4.exr", 4)]
    {
        let footage = constant_sky(name);
        let bands = bands(footage.header());
        assert_eq!(bands.len(), count);
        assert_eq!(bands[0].0 - bands[0].1 / 2.0, 395.0);
        let means = top_means(&footage.read(0, None, None).unwrap(), 4);
        let mean = means.iter().sum::<f64>() / count as f64;
        assert!((mean - 1.0).abs() < 0.01, "{name}: {mean}");
        assert!(means.iter().all(|band| (band - 1.0).abs() < 0.08), "{name}: {means:?}");
    }
}

#[test]
fn thirty_one_bands_and_four_hold_the_same_light() {
    let light = |name| {
        let footage = constant_sky(name);
        let bands = bands(footage.header());
        let widths = bands.iter().map(|band| band.1 as f32).collect();
        let all = Projection::new(bands.len(), 1, widths);
        top_means(&footage.read(0, Some(&all), None).unwrap(), 4)[0]
    };
    let (fine, coarse) =
        (light("mi_scalar_spectral_const_n31.exr"), light("mi_scalar_spectral_const_n4.exr"));
    assert!((fine / coarse - 1.0).abs() < 0.01, "{fine} {coarse}");
    assert!((fine / 310.0 - 1.0).abs() < 0.01, "{fine}");
}

#[test]
fn unrecognised_channels_are_listed_with_the_key_that_names_them() {
    let message = refusal(data("mi_scalar_spectral_const_n4.exr"), &ReadOptions::default());
    assert!(
        message.contains("`band_000`") && message.contains("channels = \"S0_{nm}nm\""),
        "{message}"
    );
}

#[test]
fn the_fichet_file_of_mitsuba_needs_no_key() {
    let footage = opened("mi_bitmap_fichet.exr", &ReadOptions::default());
    let bands = bands(footage.header());
    assert_eq!(bands.len(), 31);
    assert_eq!((bands[0], bands[30]), ((400.0, 10.0), (700.0, 10.0)));
    footage.read(0, None, None).unwrap();
}

#[test]
fn pbrt_keeps_a_preview_beside_its_buckets() {
    let footage = opened("pbrt_like_spectralfilm.exr", &ReadOptions::default());
    assert_eq!(bands(footage.header()).len(), 16);
    assert!(
        footage.header().notes.iter().any(|note| note.contains("`R`")),
        "{:?}",
        footage.header().notes
    );
    let preview = opened(
        "pbrt_like_spectralfilm.exr",
        &ReadOptions { wanted: Wanted::Rgb, ..Default::default() },
    );
    assert_eq!(preview.header().kind, Kind::Rgb(Primaries::REC709));
    assert!(matches!(preview.read(0, None, None).unwrap().planes.samples, Samples::Half(_)));
}

#[test]
fn each_plane_of_the_named_samples_holds_the_wavelength_of_its_band() {
    for name in ["names_fichet6.exr", "names_pbrt3.exr"] {
        let footage = opened(name, &ReadOptions::default());
        let means = top_means(&footage.read(0, None, None).unwrap(), 4);
        assert_eq!(means, [400.0, 500.0, 1000.0], "{name}");
        assert_eq!(
            bands(footage.header()),
            [(400.0, 100.0), (500.0, 300.0), (1000.0, 500.0)],
            "{name}"
        );
    }
    let units = bands(opened("names_units.exr", &ReadOptions::default()).header());
    let expected = [400.0, 500.0, 600.0];
    assert!(units.iter().zip(expected).all(|(band, nm)| (band.0 - nm).abs() < 1e-5), "{units:?}");
}

#[test]
fn the_rendered_sunset_has_its_published_luminances() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/sunset_mitsuba.exr");
    let footage = open(&[path], &ReadOptions::default()).unwrap();
    assert_eq!((footage.header().width, footage.header().height), (480, 270));
    let Kind::Spectral(bands) = &footage.header().kind else { panic!("not spectral") };
    let table = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cie1931_2deg.csv"),
    )
    .unwrap();
    let rows = table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let v: Vec<(f64, f64)> = rows
        .map(|row| row.split(',').map(|cell| cell.trim().parse().unwrap()).collect::<Vec<f64>>())
        .map(|row| (row[0], row[2]))
        .collect();
    let weight = |centre: f64| {
        let near =
            v.iter().min_by(|a, b| (a.0 - centre).abs().total_cmp(&(b.0 - centre).abs())).unwrap();
        (683.002 * near.1 * 10.0) as f32
    };
    let weights = bands.as_slice().iter().map(|band| weight(band.centre)).collect();
    let luminance = Projection::new(bands.len(), 1, weights);
    let frame = footage.read(0, Some(&luminance), None).unwrap();
    let Samples::Float(values) = &frame.planes.samples else { panic!("not float") };
    let largest = values.iter().fold(0f32, |a, b| a.max(*b));
    assert!((1.2e6..1.5e6).contains(&largest), "{largest}");
}

fn ramp(width: usize, height: usize) -> Planes {
    let samples = (0..width * height * 3).map(|i| i as f32 * 0.5 - 3.0).collect();
    Planes { width, height, count: 3, samples: Samples::Float(samples) }
}

fn halves(planes: &Planes) -> Planes {
    let Samples::Float(floats) = &planes.samples else { return planes.clone() };
    Planes { samples: Samples::Half(floats.iter().map(|&v| f16::from_f32(v)).collect()), ..*planes }
}

#[test]
fn what_is_written_is_read_back_with_all_that_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let aces = Primaries {
        red: [0.713, 0.293],
        green: [0.165, 0.83],
        blue: [0.128, 0.044],
        white: [0.32168, 0.33767],
    };
    let about = About {
        primaries: Some(aces),
        white: Some(Nits(5000.0)),
        frames_per_second: Some(24000.0 / 1001.0),
        sungaze: Some("{\"from\":\"Sonne über é.exr\"}".into()),
    };
    for planes in [ramp(37, 41), halves(&ramp(37, 41))] {
        for (name, compression) in Compression::ALL {
            let path = folder.path().join(format!("{name}.exr"));
            write_exr(&path, &["R", "G", "B"], &planes, compression, &about).unwrap();
            let first = std::fs::read(&path).unwrap();
            write_exr(&path, &["R", "G", "B"], &planes, compression, &about).unwrap();
            assert_eq!(first, std::fs::read(&path).unwrap(), "{name}: other bytes");
            let footage = open(&[path], &ReadOptions::default()).unwrap();
            let header = footage.header();
            assert_eq!((header.kind.clone(), header.white), (Kind::Rgb(aces), Some(Nits(5000.0))));
            assert!((header.frames_per_second.unwrap() - 23.976).abs() < 1e-3);
            let read = footage.read(0, None, Some(planes.clone())).unwrap();
            let lossless = !["b44", "b44a", "dwaa", "dwab", "pxr24"].contains(&name);
            if lossless {
                assert_eq!(read.tally.negative, 6, "{name}");
                assert_eq!(read.planes, planes, "{name}");
            }
        }
    }
}

#[test]
fn a_half_beyond_the_largest_is_written_as_the_largest() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sun.exr");
    let samples = vec![f16::INFINITY, f16::NEG_INFINITY, f16::ONE];
    let planes = Planes { width: 1, height: 1, count: 3, samples: Samples::Half(samples) };
    write_exr(&path, &["R", "G", "B"], &planes, Compression::None, &About::default()).unwrap();
    let read = open(&[path], &ReadOptions::default()).unwrap().read(0, None, None).unwrap().planes;
    assert_eq!([read.at(0, 0, 0), read.at(0, 0, 1), read.at(0, 0, 2)], [65504.0, -65504.0, 1.0]);
}

#[test]
fn a_sample_that_is_no_number_is_refused_by_name_or_mended() {
    let folder = tempfile::tempdir().unwrap();
    for names in [["R", "G", "B"], ["S0.500nm", "S0.550nm", "S0.600nm"]] {
        let path = folder.path().join("nan.exr");
        let mut planes = ramp(4, 3);
        let Samples::Float(samples) = &mut planes.samples else { panic!() };
        let of = |plane: usize, x: usize, y: usize| (y * 3 + plane) * 4 + x;
        samples[of(1, 2, 1)] = f32::NAN;
        samples[of(2, 3, 2)] = f32::INFINITY;
        write_exr(&path, &names, &planes, Compression::Zips, &About::default()).unwrap();
        let message = refusal(path.clone(), &ReadOptions::default());
        assert!(
            message.contains(&format!("channel {} is NaN at pixel (2, 1)", names[1])),
            "{message}"
        );
        let options = ReadOptions {
            non_finite: NonFinite::Clamp,
            negative: Negative::Clamp,
            ..ReadOptions::default()
        };
        let frame = open(&[path], &options).unwrap().read(0, None, None).unwrap();
        assert_eq!((frame.tally.nan, frame.tally.infinite, frame.tally.negative), (1, 1, 6));
        assert_eq!((frame.planes.at(2, 1, 1), frame.planes.at(0, 0, 0)), (0.0, 0.0));
        assert_eq!(frame.planes.at(3, 2, 2), frame.planes.at(2, 2, 2), "the largest finite value");
    }
}

#[test]
fn a_size_that_changes_is_an_error_that_names_both() {
    let folder = tempfile::tempdir().unwrap();
    let paths: Vec<PathBuf> =
        ["a.exr", "b.exr"].iter().map(|name| folder.path().join(name)).collect();
    for (path, width) in paths.iter().zip([4, 5]) {
        write_exr(path, &["R", "G", "B"], &ramp(width, 3), Compression::Rle, &About::default())
            .unwrap();
    }
    let message =
        open(&paths, &ReadOptions::default()).unwrap().read(1, None, None).unwrap_err().to_string();
    assert!(message.contains("b.exr: is 5 x 3") && message.contains("a.exr is 4 x 3"), "{message}");
}

#[test]
fn dwa_panoramas_have_negative_pixels_that_are_counted() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/panorama_sunset.exr");
    let footage = open(&[path], &ReadOptions::default()).unwrap();
    assert_eq!((footage.header().width, footage.header().height), (512, 256));
    assert!(footage.read(0, None, None).unwrap().tally.negative > 0);
}

#[test]
fn written_bytes_are_the_same_on_one_thread_and_on_three() {
    let folder = tempfile::tempdir().unwrap();
    let on = |threads: usize| {
        let path = folder.path().join(format!("{threads}.exr"));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let write = || {
            write_exr(&path, &["R", "G", "B"], &ramp(64, 200), Compression::Zip, &About::default())
        };
        pool.install(write).unwrap();
        std::fs::read(&path).unwrap()
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn frames_are_the_same_on_one_thread_and_on_three() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/sunset_mitsuba.exr");
    let footage = open(&[path], &ReadOptions::default()).unwrap();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let planes = Projection::new(31, 2, (0..62).map(|i| i as f32 * 0.37).collect());
        pool.install(|| footage.read(0, Some(&planes), None)).unwrap().planes
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn a_state_is_read_back_bit_for_bit_with_its_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.exr");
    let names = ["unbleached.L", "unbleached.M", "unbleached.S"];
    let json = "{\"time_s\":0.1}";
    let about = About { sungaze: Some(json.into()), ..About::default() };
    let planes = ramp(7, 5);
    write_exr(&path, &names, &planes, Compression::Zip, &about).unwrap();
    assert_eq!(read_exr(&path, &names, 35).unwrap(), (planes, Some(json.into())));
    assert!(read_exr(&path, &["p"], 35).unwrap_err().to_string().contains("no channel `p`"));
    assert!(read_exr(&path, &names, 34).unwrap_err().to_string().contains("max_pixels = 34"));
}
