//! Random visits, replayed by a run bit for bit.

use std::path::Path;

use proptest::prelude::*;
use sungaze::config::Config;
use sungaze::frames;
use sungaze::run::{self, Unwatched};
use sungaze::view::{self, Live};

/// One thing that somebody does: where to look, for how long, and how much of the path to go back first.
type Deed = ([f64; 2], u32, Option<f64>);

fn deeds() -> impl Strategy<Value = Vec<Deed>> {
    let gaze = prop::array::uniform2(0.0..=1.0);
    let back = prop::option::weighted(0.2, 0.0..=1.0);
    prop::collection::vec((gaze, 1u32..4000, back), 1..12)
}

/// Lives through deeds as the page's clock would: all edges at multiples of 2^-10 s.
fn lived(toml: &str, deeds: &[Deed]) -> Live {
    let config = Config::parse(toml, "test", "test", Path::new(""), &[]).unwrap();
    let mut live = Live::open(config).unwrap();
    for (gaze, parts, back) in deeds {
        if let Some(share) = back {
            live.go_to(share * live.now()).unwrap();
            while live.is_behind() {
                live.live_on().unwrap();
            }
        }
        let end = live.now() + f64::from(*parts) / 1024.0;
        assert!(live.look(*gaze, end).unwrap());
    }
    live
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, ..ProptestConfig::default() })]

    #[test]
    fn any_visit_is_replayed_to_the_last_bit(deeds in deeds(), model in prop::sample::select(vec!["auto", "tracked"])) {
        let toml = format!("input = {{ width = 48 }}\nnumerics = {{ model = \"{model}\" }}");
        let mut live = lived(&toml, &deeds);
        let folder = tempfile::tempdir().unwrap();
        let name = view::save(&live, folder.path()).unwrap();
        let config = Config::load(Some(&folder.path().join(name).join("view.toml")), &[]).unwrap();
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
            for (x, y, k) in (0..27).flat_map(|y| (0..48).flat_map(move |x| (0..3).map(move |k| (x, y, k)))) {
                prop_assert_eq!(seen.at(x, y, k).to_bits(), shown.percept.at(x, y, k).to_bits(), "look {}", i);
            }
        }
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
