//! Random visits, replayed by a run bit for bit.

use std::path::Path;

use proptest::prelude::*;
use sungaze::config::Config;
use sungaze::frames::{self, About, Compression};
use sungaze::light::{Planes, Samples};
use sungaze::run::{self, Unwatched};
use sungaze::units::Nits;
use sungaze::view::{self, Live};

/// One thing that somebody does: where to look, for how long, and how much of the path to go back first.
type Deed = ([f64; 2], u32, Option<f64>);

fn deeds() -> impl Strategy<Value = Vec<Deed>> {
    let gaze = prop::array::uniform2(0.0..=1.0);
    let back = prop::option::weighted(0.2, 0.0..=1.0);
    prop::collection::vec((gaze, 1u32..4000, back), 1..12)
}

/// Lives through deeds as the page's clock would: all edges at multiples of 2^-10 s.
fn lived(toml: &str, base: &Path, deeds: &[Deed]) -> Live {
    let config = Config::parse(toml, "test", "test", base, &[]).unwrap();
    let mut live = Live::open(config).unwrap();
    for (gaze, parts, back) in deeds {
        if let Some(share) = back {
            live.go_to(share * live.now()).unwrap();
            while live.is_behind() {
                live.live_on().unwrap();
            }
        }
        let end = live.now() + f64::from(*parts) / 1024.0;
        live.look(*gaze, end).unwrap();
    }
    live
}

/// Saves a path, runs it, and holds what was seen against what the eye sees on the same path.
fn replays(mut live: Live, size: [usize; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let name = view::save(&live, folder.path()).unwrap();
    let path = folder.path().join(&name).join(format!("{name}.toml"));
    let config = Config::load(Some(&path), &[]).unwrap();
    let out = folder.path().join("run");
    run::run(&config, &out, Default::default(), &Unwatched).unwrap();
    for (i, moment) in live.path().to_vec().into_iter().enumerate() {
        live.go_to(moment.end).unwrap();
        while live.is_behind() {
            live.live_on().unwrap();
        }
        let path = out.join(format!("seen.{:04}.exr", i + 1));
        let (seen, _) = frames::read_exr(&path, &["R", "G", "B"], 1 << 20).unwrap();
        let shown = live.picture(false);
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        for (x, y, k) in pixels.flat_map(|(x, y)| (0..3).map(move |k| (x, y, k))) {
            let (seen, shown) = (seen.at(x, y, k), shown.percept.at(x, y, k));
            assert_eq!(seen.to_bits(), shown.to_bits(), "look {i} at {x}, {y}: {seen} {shown}");
        }
    }
}

/// Four frames of a lamp that wanders to the right.
fn sequence(folder: &Path) {
    for frame in 1..=4 {
        let light = |i: usize| if i % 16 / 4 == frame - 1 { 500.0 + i as f32 } else { 0.5 };
        let samples = Samples::Float((0..16 * 8 * 3).map(light).collect());
        let planes = Planes { width: 16, height: 8, count: 3, samples };
        let path = folder.join(format!("lamp.{frame:04}.exr"));
        let about = About { white: Some(Nits(1000.0)), ..About::default() };
        frames::write_exr(&path, &["R", "G", "B"], &planes, Compression::None, &about).unwrap();
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, ..ProptestConfig::default() })]

    #[test]
    fn any_visit_is_replayed_to_the_last_bit(
        deeds in deeds(), model in prop::sample::select(vec!["auto", "tracked"])
    ) {
        let toml = format!("input = {{ width = 48 }}\nnumerics = {{ model = \"{model}\" }}");
        replays(lived(&toml, Path::new(""), &deeds), [48, 27]);
    }

    #[test]
    fn any_visit_of_a_sequence_is_too(deeds in deeds()) {
        let folder = tempfile::tempdir().unwrap();
        sequence(folder.path());
        let input = "input = { frames = \"lamp.####.exr\", horizontal_fov_deg = 8.0 }";
        let live = lived(&format!("{input}\ntime = {{ fps = 0.7 }}"), folder.path(), &deeds);
        prop_assert!(live.now() <= 4.0 / 0.7 + 1e-9, "a sequence has an end");
        replays(live, [16, 8]);
    }
}

/// What a configuration with these tables is refused for, beside a path with these rows.
fn refused(tables: &str, rows: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("gaze.csv"), format!("time_s,x,y\n{rows}")).unwrap();
    let toml = format!("input = {{ width = 16 }}\n{tables}");
    let config = Config::parse(&toml, "test", "test", folder.path(), &[]);
    let ran = config.and_then(|config| {
        run::run(&config, &folder.path().join("out"), Default::default(), &Unwatched)
    });
    ran.err().map_or("nothing".into(), |error| error.to_string())
}

#[test]
fn times_that_follow_the_gaze_need_a_path_that_begins_later_than_the_run() {
    let (time, gaze) = ("time = { times_s = \"gaze.path\" }", "gaze = { path = \"gaze.csv\" }");
    assert_eq!(refused(&format!("{time}\n{gaze}"), "0.5,0.5,0.5\n2,0.1,0.9\n"), "nothing");
    assert!(refused(time, "").contains("needs a gaze.path"));
    assert!(refused(&format!("{time}\n{gaze}"), "0,0.5,0.5\n1,0.5,0.5\n").contains("ends at 0 s"));
    let both = format!("time = {{ times_s = \"gaze.path\", duration_s = 3 }}\n{gaze}");
    assert!(refused(&both, "1,0.5,0.5\n").contains("time.duration_s"));
    assert!(refused("time = { times_s = \"gaze\" }", "").contains("gaze.path"));
}
