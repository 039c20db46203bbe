//! Random visits, replayed by a run bit for bit.

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use serde_json::{Value, json};
use sungaze::config::Config;
use sungaze::frames::{self, About, Compression};
use sungaze::light::{Planes, Samples, Window};
use sungaze::run::{self, Unwatched};
use sungaze::units::Nits;
use sungaze::view::{self, Live};

/// One thing that somebody does.
#[derive(Clone, Debug)]
enum Deed {
    /// Looks at a point for so many parts of a second of 1024; one part: a glance while time rests.
    Look([f64; 2], u32),
    /// Drags the gaze from one point to another, a look every 1/64 s.
    Drag([f64; 2], [f64; 2], u32),
    /// Goes back to a share of the time that was lived.
    Back(f64),
    Rest,
    Set(&'static str, Value),
}

fn deeds() -> impl Strategy<Value = Vec<Deed>> {
    let gaze = || prop::array::uniform2(0.0..=1.0);
    let set = prop::sample::select(vec![
        ("optics.psf", json!("none")),
        ("optics.psf", json!("stiles-holladay")),
        ("optics.draw", json!("clear")),
        ("observer.age", json!(70)),
        ("observer.pupil", json!("moon-spencer")),
        ("observer.half_bleach_log_td", json!([5.0, 5.0, 6.0])),
        ("observer.half_bleach_log_td", json!(null)),
        ("display.tone", json!("exposure")),
        ("display.exposure_ev", json!(-9.5)),
        ("display.highlights", json!(1.0)),
    ]);
    let deed = prop_oneof![
        6 => (gaze(), prop_oneof![Just(1), 1u32..4000]).prop_map(|(at, parts)| Deed::Look(at, parts)),
        2 => (gaze(), gaze(), 2u32..12).prop_map(|(from, to, looks)| Deed::Drag(from, to, looks)),
        2 => (0.0..=1.0).prop_map(Deed::Back),
        1 => Just(Deed::Rest),
        2 => set.prop_map(|(key, value)| Deed::Set(key, value)),
    ];
    prop::collection::vec(deed, 1..12)
}

/// Lives the path as far as it is wanted.
fn catch_up(live: &mut Live) {
    while live.is_behind() {
        live.live_on().unwrap();
    }
}

/// Looks as the page's clock would: all edges at multiples of 2^-10 s.
fn look(live: &mut Live, gaze: [f64; 2], parts: u32) {
    let end = live.now() + f64::from(parts) / 1024.0;
    live.look(gaze, end).unwrap();
}

fn act(live: &mut Live, deed: &Deed) {
    match deed {
        Deed::Look(gaze, parts) => look(live, *gaze, *parts),
        Deed::Drag(from, to, looks) => {
            for i in 0..*looks {
                let share = f64::from(i) / f64::from(*looks);
                look(live, [0, 1].map(|k| from[k] + share * (to[k] - from[k])), 16);
            }
        }
        Deed::Back(share) => live.go_to(share * live.now()).unwrap(),
        Deed::Rest => live.rest().unwrap(),
        Deed::Set(key, value) => live.set(&[((*key).into(), value.clone())]).unwrap(),
    }
    catch_up(live);
}

fn opened(toml: &str, base: &Path) -> Live {
    Live::open(Config::parse(toml, "test", "test", base, &[]).unwrap()).unwrap()
}

/// Lives through deeds, and ends with a look, so that there is something to save.
fn lived(toml: &str, base: &Path, deeds: &[Deed]) -> Live {
    let mut live = opened(toml, base);
    deeds.iter().for_each(|deed| act(&mut live, deed));
    look(&mut live, [0.5, 0.5], 100);
    live
}

/// Saves a viewing and runs it. Returns its name and the folder that holds it and, in `run`, what the run left.
fn rerun(live: &Live) -> (String, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let name = view::save(live, folder.path()).unwrap();
    let config = Config::load(Some(&saved(folder.path(), &name)), &[]).unwrap();
    run::run(&config, &folder.path().join("run"), Default::default(), &Unwatched).unwrap();
    (name, folder)
}

fn saved(folder: &Path, name: &str) -> PathBuf {
    folder.join(name).join(format!("{name}.toml"))
}

/// Holds what a run of a path left, `seen`, `display` and `trace.csv`, against what the eye sees on that path.
fn replays(mut live: Live) {
    let (_, folder) = rerun(&live);
    let out = folder.path().join("run");
    let trace = std::fs::read_to_string(out.join("trace.csv")).unwrap();
    let mut rows = trace.split_inclusive('\n').filter(|row| row.starts_with(char::is_numeric));
    for (i, moment) in live.path().to_vec().into_iter().enumerate() {
        live.go_to(moment.end).unwrap();
        catch_up(&mut live);
        assert_eq!(rows.next().map(str::to_owned), live.trace(), "look {i}");
        let shown = live.picture(false);
        let seen = out.join(format!("seen.{:04}.exr", i + 1));
        let (seen, _) = frames::read_exr(&seen, &["R", "G", "B"], 1 << 20).unwrap();
        let percept = &shown.percept;
        let size = [percept.width, percept.height];
        let corner = if size == [seen.width, seen.height] { [0; 2] } else { CORNER };
        let bits = |planes: &Planes, corner| bits(planes, Window { corner, size });
        assert_eq!(bits(&seen, corner), bits(percept, [0; 2]), "look {i}");
        let display = std::fs::read(out.join(format!("display.{:04}.png", i + 1))).unwrap();
        assert!(frames::decode_png(&display).unwrap().2 == shown.srgb(), "look {i}");
    }
    assert_eq!(rows.next(), None);
}

fn bits(
    planes: &Planes,
    Window { corner: [left, top], size: [width, height] }: Window,
) -> Vec<u64> {
    let pixels = (top..top + height).flat_map(|y| (left..left + width).map(move |x| (x, y)));
    pixels.flat_map(|(x, y)| (0..3).map(move |k| planes.at(x, y, k).to_bits())).collect()
}

/// Frames 1, 2, 4 and 5 of a lamp that wanders to the right.
fn sequence(folder: &Path) {
    for frame in [1, 2, 4, 5] {
        let light = |i: usize| if i % 16 / 3 == frame - 1 { 500.0 + i as f32 } else { 0.5 };
        let samples = Samples::Float((0..16 * 8 * 3).map(light).collect());
        let planes = Planes { width: 16, height: 8, count: 3, samples };
        let path = folder.join(format!("lamp.{frame:04}.exr"));
        let about = About { white: Some(Nits(1000.0)), ..About::default() };
        frames::write_exr(&path, &["R", "G", "B"], &planes, Compression::None, &about).unwrap();
    }
}

/// Where the plate's display window begins among its pixels.
const CORNER: [usize; 2] = [6, 4];

/// A still of 24 x 16 pixels whose display window is 12 x 8 of them; a lamp stands outside of it.
fn plate(folder: &Path) {
    use exr::prelude::*;
    let light = |Vec2(x, y): Vec2<usize>| if x < 3 && y < 3 { 900.0 } else { 0.1 * x as f32 };
    let colours = SpecificChannels::rgb(|at: Vec2<usize>| (light(at), 0.5 * light(at), 0.2f32));
    let mut image = Image::from_channels((24, 16), colours);
    image.layer_data.attributes.layer_position = Vec2(4, 16);
    image.attributes.display_window = IntegerBounds::new((10, 20), (12, 8));
    image.write().to_file(folder.join("plate.exr")).unwrap();
}

/// Ways to show the lamp, and when each is over, s.
const SHOWINGS: [(&str, f64); 4] = [
    ("input.range = '1-2'\ntime.fps = 0.7", 2.0 / 0.7),
    ("input.missing = 'hold'\ntime.times_s = [0, 0.3, 1.1, 1.7, 4, 5.7]", 5.7),
    ("input.missing = 'hold'\ninput.range = '1-5x2'\ntime.interval_s = 0.7", 4.2),
    ("input.range = '1,2,4'\ninput.width = 7\ntime.times_s = [0, 0.3, 1.1]", 1.9),
];

fn showing(keys: &str) -> String {
    format!("input.frames = 'lamp.####.exr'\ninput.horizontal_fov_deg = 8.0\n{keys}\n")
}

/// A few visits; as many as PROPTEST_CASES says where that is given.
fn visits() -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(6);
    ProptestConfig { cases, max_shrink_iters: 200, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(visits())]

    #[test]
    fn any_visit_is_replayed_to_the_last_bit(
        deeds in deeds(), model in prop::sample::select(vec!["auto", "tracked"])
    ) {
        let toml = format!("input = {{ width = 48 }}\nnumerics = {{ model = \"{model}\" }}");
        replays(lived(&toml, Path::new(""), &deeds));
    }

    #[test]
    fn any_visit_of_a_sequence_is_too(
        deeds in deeds(), (keys, over) in prop::sample::select(SHOWINGS.to_vec())
    ) {
        let folder = tempfile::tempdir().unwrap();
        sequence(folder.path());
        let live = lived(&showing(keys), folder.path(), &deeds);
        prop_assert!(live.now() <= over + 1e-9, "a sequence has an end");
        replays(live);
    }
}

#[test]
fn a_visit_of_a_plate_with_overscan_is_replayed_and_shows_its_display_window() {
    let folder = tempfile::tempdir().unwrap();
    plate(folder.path());
    let toml = "[input]\nframes = 'plate.exr'\nhorizontal_fov_deg = 8.0\nwhite_cd_m2 = 2000.0\n";
    let deeds = [Deed::Look([0.1, 0.2], 900), Deed::Drag([0.1, 0.2], [0.9, 0.8], 5)];
    let live = lived(toml, folder.path(), &deeds);
    let shown = live.picture(false);
    assert_eq!((shown.percept.width, shown.percept.height), (12, 8));
    replays(live);
}

#[test]
fn a_saved_viewing_of_a_sequence_opens_at_its_end_and_goes_on_to_the_end_of_the_frames() {
    for (keys, over) in SHOWINGS {
        let frames = tempfile::tempdir().unwrap();
        sequence(frames.path());
        let live = lived(&showing(keys), frames.path(), &[Deed::Look([0.2, 0.3], 700)]);
        let (name, folder) = rerun(&live);
        let config = Config::load(Some(&saved(folder.path(), &name)), &[]).unwrap();
        let mut again = Live::open(config).unwrap();
        catch_up(&mut again);
        assert_eq!((again.now(), again.trace()), (live.now(), live.trace()), "{keys}");
        while again.look([0.8, 0.5], again.now() + 0.25).unwrap() {}
        approx::assert_relative_eq!(again.now(), over, max_relative = 1e-12);
        replays(again);
    }
}

#[test]
fn a_setting_of_the_display_is_seen_at_once() {
    let mut live = opened("input.width = 32\ndisplay.tone = 'exposure'", Path::new(""));
    look(&mut live, [0.5, 0.5], 100);
    let before = live.picture(false).srgb();
    act(&mut live, &Deed::Set("display.exposure_ev", json!(-9.5)));
    assert_ne!(live.picture(false).srgb(), before);
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
