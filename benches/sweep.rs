//! Durations of one still share its light and one pass: 64 of them may take at most 1.5 times as
//! long as 8.
//!
//!     cargo bench --bench sweep

use std::path::Path;

use divan::Bencher;
use sungaze::config::Config;
use sungaze::frames::{About, Compression, write_exr};
use sungaze::light::{Planes, Samples};
use sungaze::run::{Existing, Unwatched};
use sungaze::sweep::{Part, sweep};
use sungaze::units::Nits;

fn main() {
    divan::main();
}

/// A 1080p half RGB still with a sun in it, 24 degrees across.
fn write_still(path: &Path) {
    let mut planes = Planes::half(1920, 1080, 3);
    if let Samples::Half(samples) = &mut planes.samples {
        for (i, v) in samples.iter_mut().enumerate() {
            let (x, y, plane) = (i % 1920, i / 5760, i / 1920 % 3);
            let from_sun = (x as f32 - 960.0).hypot(y as f32 - 400.0);
            let light = if from_sun < 21.0 { 3e4 } else { 20.0 + 400.0 / (1.0 + from_sun / 60.0) };
            *v = half::f16::from_f32(
                light * [1.0, 0.5, 0.2][plane] * (1.0 + 0.1 * ((x * 7 + y * 13) % 11) as f32),
            );
        }
    }
    let about = About { white: Some(Nits(10.0)), ..About::default() };
    write_exr(path, &["R", "G", "B"], &planes, Compression::Zip, &about)
        .expect("the still is written");
}

#[divan::bench(args = [8, 64], sample_count = 10)]
fn durations_of_a_1080p_still(bencher: Bencher, durations: usize) {
    let folder = tempfile::tempdir().expect("a folder");
    write_still(&folder.path().join("still.exr"));
    let text = format!(
        "[input]\nframes = \"still.exr\"\nhorizontal_fov_deg = 24\n\
         [sweep]\npictures = false\ndurations_s = {{ from = 0.01, to = 1000, count = {durations} }}\n"
    );
    let config =
        Config::parse(&text, "bench", "bench", folder.path(), &[]).expect("a configuration");
    let out = folder.path().join("out");
    bencher.bench_local(|| {
        sweep(&config, &out, Existing::Overwrite, Part::All, &Unwatched).expect("a sweep")
    });
}
