//! Frames that carry more than colours, written again with others.

mod exr_raw;

use std::path::{Path, PathBuf};

use exr::prelude::{AnyChannels, FlatSamples, Image, Layer, ReadChannels, ReadLayers, f16};
use exr_blocks::header::{Attribute, DEEP, Headers};
use exr_raw::{Channel, chunk, file, floats, ints, part};
use sungaze::colour::Primaries;
use sungaze::frames::{About, Compression, Kind, ReadOptions, open, write_percept};
use sungaze::light::{Planes, Samples};

type Layers = Vec<Layer<AnyChannels<FlatSamples>>>;

const DATA: [i32; 4] = [-3, -2, 10, 37];
const DISPLAY: [i32; 4] = [0, 0, 8, 40];
const FULL: [i32; 2] = [1, 1];
const CHANNELS: [Channel; 8] = [
    ("A", 1, FULL),
    ("B", 1, FULL),
    ("G", 1, FULL),
    ("R", 1, FULL),
    ("Z", 2, FULL),
    ("diffuse.B", 2, FULL),
    ("diffuse.G", 2, FULL),
    ("diffuse.R", 2, FULL),
];

fn saved(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// The rows of a part whose samples tell their place.
fn rows(channels: &[Channel], [left, top, right, bottom]: [i32; 4]) -> Vec<Vec<u8>> {
    let sample = |kind: i32, value: f32| match kind {
        1 => f16::from_f32(value).to_le_bytes().to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    let row = |y: i32| {
        let channel = |(c, (_, kind, _)): (usize, &Channel)| {
            let value = move |x: i32| (c as i32 * 100 + (y - top) * 7 + x - left) as f32 / 4.0;
            (left..=right).flat_map(move |x| sample(*kind, value(x))).collect::<Vec<u8>>()
        };
        channels.iter().enumerate().flat_map(channel).collect::<Vec<u8>>()
    };
    (top..=bottom).map(|y| chunk(y, &row(y))).collect()
}

/// A part in its own windows, with attributes that this program knows nothing of.
fn plate(channels: &[Channel]) -> (Vec<Attribute>, Vec<Vec<u8>>) {
    let mut header = part(channels, 0, DATA);
    header.iter_mut().filter(|attribute| attribute.name == b"displayWindow").for_each(|window| {
        window.value = ints(&DISPLAY);
    });
    header.extend([
        Attribute::new("timeCode", "timecode", ints(&[0x0102_0304, 7])),
        Attribute::new("nuke/node_hash", "string", "f00d"),
        Attribute::new("cameraFocalLength", "float", floats(&[35.0])),
        Attribute::new("an attribute whose name is longer than most", "mystery", *b"\0\x01\xff"),
        Attribute::new("whiteLuminance", "float", floats(&[80.0])),
    ]);
    (header, rows(channels, DATA))
}

/// Writes a file's percept: its picture, doubled.
fn doubled(source: &Path, options: &ReadOptions, compression: Compression) -> PathBuf {
    let footage = open(&[source.to_owned()], options).unwrap();
    let planes = footage.read(0, None, None).unwrap().planes;
    let samples = match planes.samples {
        Samples::Half(halves) => {
            Samples::Half(halves.iter().map(|half| f16::from_f32(2.0 * half.to_f32())).collect())
        }
        Samples::Float(floats) => Samples::Float(floats.iter().map(|value| 2.0 * value).collect()),
    };
    let plate = footage.plate(0).unwrap();
    let out = source.with_extension("seen.exr");
    let about = About { sungaze: Some("{}".into()), ..About::default() };
    write_percept(&out, &Planes { samples, ..planes }, compression, &about, plate.as_ref())
        .unwrap();
    out
}

fn headers(path: &Path) -> Headers {
    Headers::read(&mut &std::fs::read(path).unwrap()[..]).unwrap()
}

fn layers(path: &Path) -> Layers {
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let image: Image<exr::prelude::Layers<AnyChannels<FlatSamples>>> =
        reader.all_layers().all_attributes().from_file(path).unwrap();
    image.layer_data.into_iter().collect()
}

/// Checks that the attributes of the source stand, but for how a part is stored.
fn attributes_stand(source: &[Attribute], written: &[Attribute]) {
    let storage = [&b"compression"[..], b"lineOrder", b"type", b"chunkCount", b"tiles", b"sungaze"];
    for attribute in source.iter().filter(|attribute| !storage.contains(&&attribute.name[..])) {
        let found = written.iter().find(|written| written.name == attribute.name);
        assert_eq!(found, Some(attribute), "{}", String::from_utf8_lossy(&attribute.name));
    }
    assert!(written.iter().any(|attribute| attribute.name == b"sungaze"));
}

/// Checks a layer's samples: colours doubled where the display window shows them, all else as it
/// was.
fn only_colours_differ(before: &Layers, after: &Layers, colours: &[&str], layer: usize) {
    assert_eq!(before.len(), after.len());
    for (i, (before, after)) in before.iter().zip(after).enumerate() {
        assert_eq!(before.size, after.size);
        let pairs = before.channel_data.list.iter().zip(&after.channel_data.list);
        for (before_channel, channel) in pairs {
            let name = before_channel.name.to_string();
            assert_eq!(before_channel.name, channel.name);
            let colour = i == layer && colours.contains(&&*name);
            let width = before.size.width();
            let both =
                before_channel.sample_data.values_as_f32().zip(channel.sample_data.values_as_f32());
            for (at, (old, new)) in both.enumerate() {
                let (x, y) = ((at % width) as i32 + DATA[0], (at / width) as i32 + DATA[1]);
                let shown = (DISPLAY[0]..=DISPLAY[2]).contains(&x)
                    && (DISPLAY[1]..=DISPLAY[3]).contains(&y);
                let expected = if colour && shown { 2.0 * old } else { old };
                assert_eq!(new, expected, "{name} at {x} {y}");
            }
        }
    }
}

#[test]
fn everything_but_the_colours_passes_through_every_lossless_compression() {
    let folder = tempfile::tempdir().unwrap();
    let source = saved(folder.path(), "plate.exr", &file(0x400, vec![plate(&CHANNELS)]));
    for name in ["none", "rle", "zips", "zip", "piz"] {
        let seen = doubled(&source, &ReadOptions::default(), name.parse().unwrap());
        attributes_stand(&headers(&source).parts[0], &headers(&seen).parts[0]);
        only_colours_differ(&layers(&source), &layers(&seen), &["R", "G", "B"], 0);
    }
}

#[test]
fn the_layer_that_was_looked_at_is_the_one_that_changes() {
    let folder = tempfile::tempdir().unwrap();
    let source = saved(folder.path(), "plate.exr", &file(0x400, vec![plate(&CHANNELS)]));
    let options = ReadOptions { layer: "diffuse".into(), ..ReadOptions::default() };
    let seen = doubled(&source, &options, Compression::Zip);
    let colours = ["diffuse.R", "diffuse.G", "diffuse.B"];
    only_colours_differ(&layers(&source), &layers(&seen), &colours, 0);
}

#[test]
fn other_parts_pass_whole_flat_and_deep() {
    let folder = tempfile::tempdir().unwrap();
    let named = |name: &str, kind: &str, chunks: usize| {
        vec![
            Attribute::new("name", "string", name),
            Attribute::new("type", "string", kind),
            Attribute::new("chunkCount", "int", ints(&[chunks as i32])),
        ]
    };
    let (beauty, beauty_rows) = plate(&CHANNELS[..4]);
    let beauty = [beauty, named("beauty", "scanlineimage", beauty_rows.len())].concat();
    let masks = [part(&[("id", 2, FULL)], 0, DATA), named("masks", "scanlineimage", 40)].concat();
    let masks_rows = rows(&[("id", 2, FULL)], DATA);
    let version = Attribute::new("version", "int", ints(&[1]));
    let deep = [part(&[("Z", 2, FULL)], 0, [0, 0, 1, 1]), named("deep", "deepscanline", 2)];
    let deep = [deep.concat(), vec![version]].concat();
    let samples = |y: i32| {
        let sizes: Vec<u8> = [8u64, 4, 4].iter().flat_map(|size| size.to_le_bytes()).collect();
        [ints(&[y]), sizes, ints(&[0, 1]), floats(&[2.5])].concat()
    };
    let flat = [(masks, masks_rows), (beauty, beauty_rows)];
    let source = saved(folder.path(), "flat.exr", &file(0x400, flat.to_vec()));
    let seen = doubled(&source, &ReadOptions::default(), Compression::Zip);
    assert_eq!(headers(&source).parts[0], headers(&seen).parts[0]);
    attributes_stand(&headers(&source).parts[1], &headers(&seen).parts[1]);
    only_colours_differ(&layers(&source), &layers(&seen), &["R", "G", "B"], 1);

    let all = [flat.to_vec(), vec![(deep, vec![samples(0), samples(1)])]].concat();
    let source = saved(folder.path(), "deep.exr", &file(0x400 | DEEP, all));
    let seen = doubled(&source, &ReadOptions::default(), Compression::Zip);
    assert_eq!(headers(&source).parts[2], headers(&seen).parts[2]);
    assert_eq!(headers(&seen).flags & DEEP, DEEP);
    let bytes = std::fs::read(&seen).unwrap();
    let chunk = [ints(&[2]), samples(1)].concat();
    assert!(bytes.windows(chunk.len()).any(|window| window == chunk), "the deep chunk is there");
}

#[test]
fn a_grey_picture_and_a_spectral_one_get_colours_in_the_place_of_what_they_were_made_of() {
    let folder = tempfile::tempdir().unwrap();
    let names = |path: &Path| -> Vec<String> {
        layers(path)[0].channel_data.list.iter().map(|channel| channel.name.to_string()).collect()
    };
    let grey = [("A", 1, FULL), ("Y", 1, FULL), ("Z", 2, FULL)];
    let source = saved(folder.path(), "grey.exr", &file(0x400, vec![plate(&grey)]));
    let seen = doubled(&source, &ReadOptions::default(), Compression::Zip);
    assert_eq!(names(&seen), ["A", "B", "G", "R", "Z"]);
    let bands = [
        ("A", 1, FULL),
        ("R", 1, FULL),
        ("S0.500nm", 2, FULL),
        ("S0.550nm", 2, FULL),
        ("S0.600nm", 2, FULL),
    ];
    let source = saved(folder.path(), "bands.exr", &file(0x400, vec![plate(&bands)]));
    let seen = doubled(&source, &ReadOptions::default(), Compression::Zip);
    assert_eq!(names(&seen), ["A", "B", "G", "R"]);
    let white = |path: &Path| {
        let attributes = headers(path).parts.remove(0);
        attributes.into_iter().find(|attribute| attribute.name == b"whiteLuminance")
    };
    assert_eq!(white(&source).map(|white| white.value), Some(floats(&[80.0])));
}

#[test]
fn each_frame_is_written_in_its_own_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let paths = [100.0f32, 300.0].map(|white| {
        let attribute = Attribute::new("whiteLuminance", "float", floats(&[white]));
        let bytes = exr_raw::constant(&[("R", 1.0), ("G", 2.0), ("B", 4.0)], vec![attribute]);
        saved(folder.path(), &format!("{white}.exr"), &bytes)
    });
    let footage = open(&paths, &ReadOptions::default()).unwrap();
    let planes = footage.read(1, None, None).unwrap().planes;
    assert_eq!(planes.at(0, 0, 0), 3.0);
    let seen = folder.path().join("seen.exr");
    let plate = footage.plate(1).unwrap();
    write_percept(&seen, &planes, Compression::Zip, &About::default(), plate.as_ref()).unwrap();
    let read = open(&[seen], &ReadOptions::default()).unwrap();
    assert_eq!(read.header().white.map(|white| white.0), Some(300.0));
    assert_eq!(read.read(0, None, None).unwrap().planes.at(0, 0, 0), 1.0);
}

#[test]
fn a_plate_whose_other_part_is_damaged_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let named = |name: &str| {
        vec![
            Attribute::new("name", "string", name),
            Attribute::new("type", "string", "scanlineimage"),
            Attribute::new("chunkCount", "int", ints(&[40])),
        ]
    };
    let (beauty, beauty_rows) = plate(&CHANNELS[..4]);
    let masks = [part(&[("id", 2, FULL)], 0, DATA), named("masks")].concat();
    let parts = vec![
        ([beauty, named("beauty")].concat(), beauty_rows),
        (masks, rows(&[("id", 2, FULL)], DATA)),
    ];
    let bytes = file(0x400, parts);
    let source = saved(folder.path(), "cut.exr", &bytes[..bytes.len() - 5]);
    let footage = open(&[source], &ReadOptions::default()).unwrap();
    let planes = footage.read(0, None, None).unwrap().planes;
    let (seen, plate) = (folder.path().join("seen.exr"), footage.plate(0).unwrap());
    let written =
        write_percept(&seen, &planes, Compression::Zip, &About::default(), plate.as_ref());
    let message = written.unwrap_err().to_string();
    assert!(
        message.contains("seen.exr: cannot write") && message.contains("cut short"),
        "{message}"
    );
    assert!(!seen.exists());
}

#[test]
fn primaries_that_were_given_are_those_of_what_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let (mut header, rows) = plate(&CHANNELS);
    let wrong = floats(&[0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329]);
    header.push(Attribute::new("chromaticities", "chromaticities", wrong.clone()));
    let source = saved(folder.path(), "plate.exr", &file(0x400, vec![(header, rows)]));
    let written = |primaries: Option<Primaries>| {
        let options = ReadOptions { primaries, ..ReadOptions::default() };
        let footage = open(std::slice::from_ref(&source), &options).unwrap();
        let Kind::Rgb(primaries) = footage.header().kind else { panic!("not RGB") };
        let about = About { primaries: Some(primaries), ..About::default() };
        let (planes, plate) =
            (footage.read(0, None, None).unwrap().planes, footage.plate(0).unwrap());
        let out = folder.path().join("seen.exr");
        write_percept(&out, &planes, Compression::Zip, &about, plate.as_ref()).unwrap();
        let attributes = headers(&out).parts.remove(0);
        attributes.into_iter().find(|a| a.name == b"chromaticities").unwrap().value
    };
    assert_eq!(written(None), wrong);
    let acescg = floats(&[0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767]);
    assert_eq!(written(Some(Primaries::ACESCG)), acescg);
}

#[test]
fn of_blenders_layers_the_combined_one_is_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let of_layer = |layer: &'static str| ["A", "B", "G", "R"].map(|name| format!("{layer}.{name}"));
    let opened = |layers: &[&'static str]| {
        let mut names: Vec<String> = layers.iter().flat_map(|layer| of_layer(layer)).collect();
        names.sort();
        let channels: Vec<Channel> = names.iter().map(|name| (&**name, 1, FULL)).collect();
        let path = saved(folder.path(), "b.exr", &file(0x400, vec![plate(&channels)]));
        open(&[path], &ReadOptions::default())
    };
    let footage = opened(&["View.Combined", "View.DiffDir"]).unwrap();
    // Red is the fourth of its channels; see `rows`.
    let red = footage.read(0, None, None).unwrap().planes.at(0, 0, 0);
    assert_eq!(red, (300.0 + 2.0 * 7.0 + 3.0) / 4.0);
    assert!(footage.header().notes.contains(&"layer `View.Combined`".into()));
    for ambiguous in [&["A.Combined", "B.Combined"], &["View.DiffDir", "View.Emit"]] {
        let problem = opened(ambiguous).map(|_| ()).unwrap_err().to_string();
        assert!(problem.contains("another layer or part is chosen by `layer`"), "{problem}");
    }
}
