//! Frames in files: each compression of OpenEXR written and read, and a whole run from disk to
//! disk.

use std::path::Path;

use half::f16;
use sungaze::config::Config;
use sungaze::frames::{About, Compression, read_exr, write_exr};
use sungaze::light::{Planes, Samples};
use sungaze::run::{Existing, Unwatched, run};

use super::{Case, Planned, noise, planned};

const NAMES: [&str; 3] = ["R", "G", "B"];
/// The codes that lose nothing.
const CODES: [&str; 5] = ["none", "rle", "zips", "zip", "piz"];
const FRAMES: usize = 8;

/// The same picture written and read in each code, and a run over frames of it.
pub(crate) fn all(size: [usize; 2]) -> Vec<Planned> {
    let writing = |code| {
        planned(format!("write EXR, {code}"), move |name| written(name, &evening(size), code))
    };
    let reading =
        |code| planned(format!("read EXR, {code}"), move |name| read(name, &evening(size), code));
    let whole =
        planned("run, ZIP in and out, a frame of it", move |name| whole_run(name, &evening(size)));
    CODES.into_iter().flat_map(|code| [writing(code), reading(code)]).chain([whole]).collect()
}

/// A low sun over smooth light, with two per cent of noise.
fn evening([width, height]: [usize; 2]) -> Planes {
    let sun = [0.5 * width as f32, 0.4 * height as f32];
    let sample = |i: usize| {
        let (x, y, plane) = (i % width, i / (3 * width), i / width % 3);
        let from_sun = (x as f32 - sun[0]).hypot(y as f32 - sun[1]) / width as f32;
        let light = if from_sun < 0.01 { 3e4 } else { 20.0 + 400.0 / (1.0 + 30.0 * from_sun) };
        f16::from_f32(light * [1.0, 0.5, 0.2][plane] * (0.99 + 0.02 * noise(i)))
    };
    Planes {
        width,
        height,
        count: 3,
        samples: Samples::Half((0..3 * width * height).map(sample).collect()),
    }
}

fn write(path: &Path, planes: &Planes, code: &str) {
    let compression: Compression = code.parse().expect("a code of the list");
    write_exr(path, &NAMES, planes, compression, &About::default()).expect("a frame is written");
}

fn size_of(path: &Path) -> usize {
    std::fs::metadata(path).expect("a frame was written").len() as usize
}

fn written(name: String, planes: &Planes, code: &'static str) -> Case {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("f.exr");
    write(&path, planes, code);
    let (bytes, packed, planes) =
        (6 * planes.width * planes.height, size_of(&path), planes.clone());
    let share = 100.0 * packed as f64 / bytes as f64;
    let work = move || write(&folder.path().join("f.exr"), &planes, code);
    Case::new(format!("{name}: {share:.0} % of the bytes"), bytes + packed, work)
}

fn read(name: String, planes: &Planes, code: &'static str) -> Case {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("f.exr");
    write(&path, planes, code);
    let pixels = planes.width * planes.height;
    let bytes = 6 * pixels + size_of(&path);
    let work = move || {
        let planes = read_exr(&folder.path().join("f.exr"), &NAMES, pixels as u64);
        std::hint::black_box(planes.expect("a frame is read"));
    };
    Case::new(name, bytes, work)
}

/// Frames read, looked at with pigment tracked, and written.
fn whole_run(name: String, planes: &Planes) -> Case {
    let folder = tempfile::tempdir().expect("a folder");
    let frame = |i: usize| folder.path().join(format!("f.{i:04}.exr"));
    write(&frame(1), planes, "zip");
    (2..=FRAMES).for_each(|i| std::fs::copy(frame(1), frame(i)).map(drop).expect("a copy"));
    let text = "[input]\nframes = \"f.####.exr\"\nhorizontal_fov_deg = 60\nwhite_cd_m2 = 10\n\
                [numerics]\nmodel = \"tracked\"\n\
                [output]\ndisplay = \"none\"\nstate = \"none\"\ncompression = \"zip\"\n";
    let config =
        Config::parse(text, "bench", "bench", folder.path(), &[]).expect("a configuration");
    let bytes = FRAMES * (planes.width * planes.height * (6 + 6 + 48) + 2 * size_of(&frame(1)));
    let work = move || {
        run(&config, &folder.path().join("out"), Existing::Overwrite, &Unwatched).expect("a run");
    };
    Case { frames: FRAMES, whole_machine: true, ..Case::new(name, bytes, work) }
}
