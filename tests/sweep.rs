//! Sweeps: their numbers against the closed form, and their files whichever way the cases were run.

use std::collections::HashMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use proptest::prelude::*;
use sungaze::config::Config;
use sungaze::kinetics::{Kinetics, Law};
use sungaze::run::{Existing, Unwatched};
use sungaze::sweep::{self, Part};
use sungaze::units::{Seconds, Trolands};

const SMALL: &str = "[input]\nwidth = 64\n[sweep]\npictures = false\n";

fn program(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    command.current_dir(folder).arg("sweep").args(arguments).arg("--quiet");
    command
}

fn sungaze(folder: &Path, arguments: &[&str]) -> Output {
    program(folder, arguments).output().expect("the program starts")
}

fn told(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!text.contains("panicked"), "{text}");
    text
}

fn succeeds(folder: &Path, arguments: &[&str]) {
    let output = sungaze(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", told(&output));
}

/// The table of a sweep as rows by column name.
fn table(toml: &str) -> Vec<HashMap<String, f64>> {
    let folder = tempfile::tempdir().unwrap();
    let config = Config::parse(toml, "test", "test", folder.path(), &[]).unwrap();
    let out = folder.path().join("out");
    let outcome = sweep::sweep(&config, &out, Existing::Refuse, Part::All, &Unwatched).unwrap();
    let text = std::fs::read_to_string(outcome.table.unwrap()).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().rsplitn(22, ',').take(21).collect();
    let numbers = |line: &str| {
        let last = names
            .iter()
            .zip(line.rsplitn(22, ','))
            .map(|(name, v)| ((*name).to_owned(), v.parse().unwrap()));
        last.chain([("duration_s".to_owned(), line.split(',').nth(1).unwrap().parse().unwrap())])
            .collect()
    };
    lines.map(numbers).collect()
}

fn triple(row: &HashMap<String, f64>, name: &str) -> [f64; 3] {
    ["L", "M", "S"].map(|cone| row[&format!("{name}_{cone}")])
}

/// Everything in a folder, by path.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(
                files(&path).into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)),
            );
        } else {
            found.push((name, std::fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

#[test]
fn every_duration_has_the_closed_form_of_the_light_that_it_reports() {
    let rows = table(&format!(
        "{SMALL}durations_s = [0, 1e-6, 0.01, 0.3, 1, 30, 1e3, 1e6]\n[[sweep.vary]]\nkey = \"input.sun_elevation_deg\"\nvalues = [0.25, 10]\n\
         [[sweep.vary]]\nkey = \"gaze.at\"\nvalues = [[0.5, 0.5], [0.1, 0.1]]\n[numerics]\nmodel = \"tracked\"\n"
    ));
    assert_eq!(rows.len(), 4 * 8);
    for row in &rows {
        let (t, light, p) = (row["duration_s"], triple(row, "I"), triple(row, "p"));
        for (k, half_bleach) in [10f64.powf(4.3), 10f64.powf(4.3), 1e5].into_iter().enumerate() {
            let a = 1.0 + light[k] / half_bleach;
            let expected = 1.0 / a + (1.0 - 1.0 / a) * (-t / 120.0 * a).exp();
            assert!(
                (p[k] - expected).abs() < 1e-5,
                "{t} s, {} td: {} for {expected}",
                light[k],
                p[k]
            );
        }
        assert!(t > 0.0 || p == [1.0; 3], "the start is unbleached");
    }
}

#[test]
fn the_nonlinear_laws_stay_within_budget_of_a_thousand_substeps() {
    for (name, law) in &Law::NAMES[1..] {
        let rows = table(&format!(
            "{SMALL}durations_s = [0.03, 1, 2, 40, 200, 1e4]\n[observer]\nkinetics = \"{name}\"\n[[sweep.vary]]\nkey = \"gaze.at\"\nvalues = [[0.5, 0.5], [0.1, 0.1]]\n"
        ));
        let density = [0.50, 0.50, 0.40];
        for row in &rows {
            let (light, p) = (triple(row, "I"), triple(row, "p"));
            for k in 0..3 {
                let law = law.with(density[k], 0.2);
                let half_bleach = Trolands([10f64.powf(4.3), 10f64.powf(4.3), 1e5][k]);
                let pigment = Kinetics { law, half_bleach, tau: Seconds(120.0) };
                let truth = finely(&pigment, light[k], row["duration_s"]);
                assert!((p[k] - truth).abs() < 1e-3, "{} for {truth}, {row:?}", p[k]);
            }
        }
    }
}

/// p after a rest and then held light, by steps that grow from 1e-9 of the time constant.
fn finely(pigment: &Kinetics, light: f64, until: f64) -> f64 {
    let (mut p, mut now) = (1.0, 0.0);
    let mut step: f64 = 1e-9;
    while now < until {
        let h = step.min(until - now);
        p = sungaze::step::advance(pigment, p, Trolands(light), Seconds(h), 4);
        (now, step) = (now + h, step * 1.01);
    }
    p
}

#[test]
fn one_process_an_array_of_jobs_and_any_number_of_threads_leave_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[input]\nwidth = 64\n[sweep]\ndurations_s = [0, 0.5, 2]\n[[sweep.vary]]\nkey = \"observer.half_bleach_log_td\"\n\
                values = [[4.3, 4.3, 5.0], [3.89, 3.89, 3.89]]\n[[sweep.vary]]\nkey = \"input.sun_elevation_deg\"\nvalues = [0.5, 2]\n";
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    succeeds(folder.path(), &["s.toml", "--out", "one", "--threads", "1"]);
    for index in ["3", "0", "2", "1"] {
        succeeds(folder.path(), &["s.toml", "--out", "many", "--index", index, "--threads", "3"]);
    }
    succeeds(folder.path(), &["s.toml", "--out", "many", "--merge"]);
    let (one, many) = (files(&folder.path().join("one")), files(&folder.path().join("many")));
    let names =
        |files: &[(String, Vec<u8>)]| files.iter().map(|file| file.0.clone()).collect::<Vec<_>>();
    assert_eq!(names(&one), names(&many));
    for name in [
        "sweep.csv",
        "contact.png",
        "sweep.svg",
        "case.0003/seen.0003.exr",
        "case.0000/display.0001.png",
    ] {
        assert!(names(&one).contains(&name.to_owned()), "{name} of {:?}", names(&one));
    }
    assert!(one.iter().zip(&many).all(|(a, b)| a.1 == b.1));
    let table = std::fs::read_to_string(folder.path().join("one/sweep.csv")).unwrap();
    let head = "case,duration_s,observer.half_bleach_log_td,input.sun_elevation_deg,probe,I_L,I_M,I_S,p_L,p_M,p_S,X,Y,Z,x,y,pupil_mm,lost_L,lost_M,lost_S,steady_p_L,steady_p_M,steady_p_S,recovery_95_s,recovery_50_s,recovery_90_s\n\
                0,0,\"[4.3, 4.3, 5.0]\",0.5,gaze,";
    assert!(table.starts_with(head), "{table}");
    assert_eq!(table.lines().count(), 1 + 4 * 3);
}

#[test]
fn a_sweep_killed_at_any_moment_and_run_again_is_as_if_never_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[input]\nwidth = 160\n[sweep]\ndurations_s = { from = 0.1, to = 10, count = 6 }\n[[sweep.vary]]\nkey = \"observer.age\"\nvalues = [20, 40, 60, 80]\n";
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    succeeds(folder.path(), &["s.toml", "--out", "whole"]);
    for milliseconds in [5, 40, 90, 170, 300] {
        let mut child = program(folder.path(), &["s.toml", "--out", "killed"])
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(milliseconds));
        let _ = child.kill();
        child.wait().unwrap();
    }
    succeeds(folder.path(), &["s.toml", "--out", "killed", "--resume"]);
    assert_eq!(files(&folder.path().join("whole")), files(&folder.path().join("killed")));
}

#[test]
fn finished_cases_are_kept_and_other_settings_are_refused_with_their_key() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), format!("{SMALL}durations_s = [0, 1]\n")).unwrap();
    succeeds(folder.path(), &["s.toml", "--out", "o"]);
    let cells = folder.path().join("o/case.0000/cells.csv");
    let written = std::fs::metadata(&cells).unwrap().modified().unwrap();
    succeeds(folder.path(), &["s.toml", "--out", "o"]);
    assert_eq!(std::fs::metadata(&cells).unwrap().modified().unwrap(), written);
    for (set, key) in
        [("observer.age=50", "observer.age"), ("sweep.durations_s=[0, 2]", "sweep.durations_s")]
    {
        let refused = sungaze(folder.path(), &["s.toml", "--out", "o", "--set", set]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(told(&refused).contains(key), "{}", told(&refused));
    }
    succeeds(folder.path(), &["s.toml", "--out", "o", "--set", "observer.age=50", "--overwrite"]);
    std::fs::create_dir(folder.path().join("mine")).unwrap();
    std::fs::write(folder.path().join("mine/letter.txt"), "dear").unwrap();
    let refused = sungaze(folder.path(), &["s.toml", "--out", "mine"]);
    assert!(
        refused.status.code() == Some(2) && told(&refused).contains("letter.txt"),
        "{}",
        told(&refused)
    );
}

#[test]
fn a_folder_that_no_sweep_made_is_refused_and_strangers_files_in_a_case_stay() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), format!("{SMALL}durations_s = [0, 1]\n")).unwrap();
    let backup = folder.path().join("o/case.0000/seen.backup.exr");
    std::fs::create_dir_all(backup.parent().unwrap()).unwrap();
    std::fs::write(&backup, "mine").unwrap();
    for flag in [&[][..], &["--resume"], &["--overwrite"]] {
        let refused = sungaze(folder.path(), &[&["s.toml", "--out", "o"], flag].concat());
        assert_eq!(refused.status.code(), Some(2), "{}", told(&refused));
    }
    succeeds(folder.path(), &["s.toml", "--out", "p"]);
    let mine = folder.path().join("p/case.0000/seen.0001.exr");
    std::fs::write(&mine, "mine").unwrap();
    let held = sungaze(folder.path(), &["s.toml", "--out", "p", "--overwrite"]);
    assert_eq!(held.status.code(), Some(1), "{}", told(&held));
    assert!(told(&held).contains("case.0000"), "{}", told(&held));
    assert!([backup, mine].iter().all(|path| std::fs::read_to_string(path).unwrap() == "mine"));
}

#[test]
fn a_case_that_has_lost_a_picture_is_done_again() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[input]\nwidth = 64\n[sweep]\ndurations_s = [0, 1]\n";
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    succeeds(folder.path(), &["s.toml", "--out", "o"]);
    let whole = files(&folder.path().join("o"));
    std::fs::remove_file(folder.path().join("o/case.0000/seen.0002.exr")).unwrap();
    succeeds(folder.path(), &["s.toml", "--out", "o"]);
    assert_eq!(files(&folder.path().join("o")), whole);
}

#[test]
fn sweeps_that_share_a_folder_do_not_harm_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[input]\nwidth = 96\n[sweep]\ndurations_s = [0, 0.3, 1, 3]\n[[sweep.vary]]\nkey = \"observer.age\"\nvalues = [20, 40, 60]\n";
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    succeeds(folder.path(), &["s.toml", "--out", "whole"]);
    let start = || {
        let mut sweep = program(folder.path(), &["s.toml", "--out", "o"]);
        sweep.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    };
    let mut sweeps: Vec<_> = (0..4).map(|_| start()).collect();
    std::thread::sleep(Duration::from_millis(60));
    sweeps[1].kill().unwrap();
    let codes: Vec<_> = sweeps.iter_mut().map(|sweep| sweep.wait().unwrap().code()).collect();
    assert_eq!((codes[0], codes[2], codes[3]), (Some(0), Some(0), Some(0)));
    succeeds(folder.path(), &["s.toml", "--out", "o"]);
    assert_eq!(files(&folder.path().join("whole")), files(&folder.path().join("o")));
}

#[test]
fn a_merge_of_unfinished_cases_names_them_and_an_index_past_the_end_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{SMALL}durations_s = [1]\n[[sweep.vary]]\nkey = \"observer.age\"\nvalues = [20, 40, 60]\n"
    );
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    succeeds(folder.path(), &["s.toml", "--out", "o", "--index", "1"]);
    let merge = sungaze(folder.path(), &["s.toml", "--out", "o", "--merge"]);
    assert!(
        merge.status.code() == Some(1) && told(&merge).contains("--index 0, 2"),
        "{}",
        told(&merge)
    );
    let beyond = sungaze(folder.path(), &["s.toml", "--out", "o", "--index", "3"]);
    assert!(
        beyond.status.code() == Some(2) && told(&beyond).contains("0 to 2"),
        "{}",
        told(&beyond)
    );
    let list = sungaze(folder.path(), &["s.toml", "--list"]);
    let lines = String::from_utf8(list.stdout).unwrap();
    assert_eq!(lines, "0  observer.age = 20\n1  observer.age = 40\n2  observer.age = 60\n");
}

#[test]
fn a_pattern_without_files_is_refused_at_its_line_or_at_the_value_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let base =
        "[input]\nhorizontal_fov_deg = 8\nframes = \"no.####.exr\"\n[sweep]\ndurations_s = [1]\n";
    let varied =
        format!("{base}[[sweep.vary]]\nkey = \"input.frames\"\nvalues = [\n\"nor.####.exr\"]\n");
    for (text, line) in [(base, 3), (&varied, 9)] {
        std::fs::write(folder.path().join("s.toml"), text).unwrap();
        let refused = sungaze(folder.path(), &["s.toml", "--out", "o"]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(
            told(&refused).contains(&format!("s.toml:{line}: input.frames: ")),
            "{}",
            told(&refused)
        );
    }
}

/// Three small frames that differ, and a gaze that wanders over them.
fn write_sequence(folder: &Path) {
    use sungaze::frames::{About, Compression, write_exr};
    use sungaze::light::{Planes, Samples};
    for frame in 1..=3u32 {
        let mut planes = Planes::float(24, 16, 3);
        if let Samples::Float(samples) = &mut planes.samples {
            samples
                .iter_mut()
                .enumerate()
                .for_each(|(i, v)| *v = (i * 31 % 97 * frame as usize) as f32);
        }
        let about = About { white: Some(sungaze::units::Nits(2000.0)), ..About::default() };
        write_exr(
            &folder.join(format!("f.{frame:04}.exr")),
            &["R", "G", "B"],
            &planes,
            Compression::Zip,
            &about,
        )
        .unwrap();
    }
    std::fs::write(folder.join("gaze.csv"), "time_s,x,y\n0,0.5,0.5\n3,0.8,0.3\n").unwrap();
}

const SEQUENCE: &str = "[input]\nframes = \"f.####.exr\"\nhorizontal_fov_deg = 8\n[numerics]\nmodel = \"tracked\"\n[time]\nfps = 1\n[gaze]\npath = \"gaze.csv\"\n\
                        [[output.probe]]\nname = \"a\"\nat = [0.3, 0.4]\n[[output.probe]]\nname = \"b\"\nat = [0.9, 0.1]\n";

fn samples(path: &Path) -> sungaze::light::Samples {
    let footage = sungaze::frames::open(&[path.to_owned()], &Default::default()).unwrap();
    footage.read(0, None, None).unwrap().planes.samples
}

/// The rows of a table's last time, from `probe` to `lost_S`.
fn last_rows(table: &str, from: usize, count: usize) -> Vec<String> {
    let rows = table.lines().rev().take(count);
    rows.map(|row| row.split(',').skip(from).take(15).collect::<Vec<_>>().join(",")).collect()
}

/// Holds every cell of a sweep against the last frame of the run that ends there. `ends`: the
/// `times_s` of that run; `durations`: those of the sweep, from 0.
fn cells_are_runs(folder: &Path, toml: &str, durations: &[f64], ends: impl Fn(usize) -> String) {
    let text = format!("{toml}[sweep]\ndurations_s = {durations:?}\n");
    let config = Config::parse(&text, "test", "test", folder, &[]).unwrap();
    let swept = tempfile::tempdir().unwrap();
    sweep::sweep(&config, swept.path(), Existing::Refuse, Part::All, &Unwatched).unwrap();
    let table = std::fs::read_to_string(swept.path().join("sweep.csv")).unwrap();
    for (cell, duration) in durations.iter().enumerate() {
        let sets = [format!("time.times_s={}", ends(cell.max(1)))];
        let config = Config::parse(toml, "test", "test", folder, &sets).unwrap();
        let ran = tempfile::tempdir().unwrap();
        let report = sungaze::run::run(&config, ran.path(), Existing::Refuse, &Unwatched);
        let frames = report.unwrap().report["frames"]["count"].as_u64().unwrap();
        let name = if cell == 0 { "start".into() } else { format!("{frames:04}") };
        let seen = swept.path().join(format!("case.0000/seen.{:04}.exr", cell + 1));
        let same = samples(&seen) == samples(&ran.path().join(format!("seen.{name}.exr")));
        assert!(same, "{toml}\n{duration} s");
        let probes = std::fs::read_to_string(ran.path().join("probes.csv")).unwrap();
        let upto: String = table
            .lines()
            .take_while(|row| {
                row.split(',').nth(1).unwrap().parse().map_or(true, |d: f64| d <= *duration)
            })
            .map(|row| format!("{row}\n"))
            .collect();
        if cell > 0 {
            let count = if toml.contains("output.probe") { 2 } else { 1 };
            assert_eq!(last_rows(&upto, 2, count), last_rows(&probes, 2, count), "{toml}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_cell_is_the_last_frame_of_the_run_that_ends_there(
        mut durations in prop::collection::vec(1e-2f64..50.0, 1..4),
        law in 0usize..3,
        model in 0usize..3,
        start in 0usize..2,
        wanders in any::<bool>(),
        at in prop::array::uniform2(0.0f64..1.0),
    ) {
        durations.sort_by(f64::total_cmp);
        durations.dedup();
        durations.insert(0, 0.0);
        let folder = tempfile::tempdir().unwrap();
        write_sequence(folder.path());
        let [law, model, start] = [
            ["first-order", "self-screened", "rate-limited"][law],
            ["auto", "tracked", "steady"][model],
            ["rested", "adapted"][start],
        ];
        let gaze = if wanders { "at = \"brightest\"".into() } else { format!("at = {at:?}") };
        let toml = format!(
            "[input]\nframes = \"f.0002.exr\"\nhorizontal_fov_deg = 8\n\
             [observer]\nkinetics = \"{law}\"\nstart = \"{start}\"\npupil_closing_s = 0.2\n\
             [numerics]\nmodel = \"{model}\"\n[gaze]\n{gaze}\n"
        );
        cells_are_runs(folder.path(), &toml, &durations, |cell| format!("{:?}", &durations[..=cell]));
    }
}

#[test]
fn durations_that_do_not_add_up_to_the_bit_are_held_like_the_times_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    write_sequence(folder.path());
    let durations = [0.0, 0.5883132248206397, 26.75952669248421, 32.44785621574006];
    assert_ne!(durations[1] + (durations[2] - durations[1]), durations[2]);
    let toml = "[input]\nframes = \"f.0002.exr\"\nhorizontal_fov_deg = 8\n\
                [gaze]\nat = \"brightest\"\n";
    cells_are_runs(folder.path(), toml, &durations, |cell| format!("{:?}", &durations[..=cell]));
}

#[test]
fn a_cell_of_a_sequence_under_a_wandering_gaze_is_the_last_frame_of_the_run_that_ends_there() {
    let folder = tempfile::tempdir().unwrap();
    write_sequence(folder.path());
    let toml = SEQUENCE.replace("fps = 1\n", "");
    // The second frame is cut at 1.25 s, so the run has it twice.
    let frames = "[\"f.0001.exr\", \"f.0002.exr\", \"f.0002.exr\", \"f.0003.exr\"]";
    let toml = toml.replace("\"f.####.exr\"", frames);
    let edges = [0.0, 1.0, 1.25, 2.0, 3.0];
    let whole = format!("{toml}[sweep]\ndurations_s = {:?}\n", &edges[1..]);
    let whole = whole.replace("[time]\n", "[time]\ntimes_s = [0, 1, 1.25, 2, 3]\n");
    let cut = format!("{SEQUENCE}[sweep]\ndurations_s = {:?}\n", &edges[1..]);
    let out = |name: &str| folder.path().join(name);
    for (name, text) in [("whole", &whole), ("cut", &cut)] {
        let config = Config::parse(text, "test", "test", folder.path(), &[]).unwrap();
        sweep::sweep(&config, &out(name), Existing::Refuse, Part::All, &Unwatched).unwrap();
    }
    let table = |name: &str| std::fs::read_to_string(out(name).join("sweep.csv")).unwrap();
    assert_eq!(table("whole"), table("cut"));
    let config = whole.split("[sweep]").next().unwrap();
    let config = Config::parse(config, "test", "test", folder.path(), &[]).unwrap();
    sungaze::run::run(&config, &out("ran"), Existing::Refuse, &Unwatched).unwrap();
    for frame in 1..=4 {
        let seen = |place: &str| samples(&out(&format!("{place}/seen.{frame:04}.exr")));
        assert!(seen("cut/case.0000") == seen("ran"), "frame {frame}");
    }
    let probes = std::fs::read_to_string(out("ran/probes.csv")).unwrap();
    assert_eq!(last_rows(&table("cut"), 2, 8), last_rows(&probes, 2, 8));
}

#[test]
fn a_sequence_that_ends_before_the_last_duration_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    write_sequence(folder.path());
    std::fs::write(
        folder.path().join("s.toml"),
        format!("{SEQUENCE}[sweep]\ndurations_s = [1, 3.5]\n"),
    )
    .unwrap();
    let refused = sungaze(folder.path(), &["s.toml", "--out", "o"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        told(&refused).contains("sweep.durations_s: found 3.5, but the frames end at 3 s"),
        "{}",
        told(&refused)
    );
}

#[test]
fn the_probes_of_a_still_do_not_depend_on_pictures_and_its_start_may_be_adapted() {
    let with = |pictures: bool, start: &str| {
        table(&format!(
            "[input]\nwidth = 64\n[observer]\nstart = \"{start}\"\n[sweep]\ndurations_s = [0, 1, 20]\npictures = {pictures}\n"
        ))
    };
    assert_eq!(with(true, "rested"), with(false, "rested"));
    let adapted = with(false, "adapted");
    assert!(adapted.windows(2).all(|rows| (rows[0]["p_L"] - rows[1]["p_L"]).abs() < 1e-12));
    assert!(adapted[0]["p_L"] < 0.5);
}

#[test]
fn frames_that_had_to_be_mended_are_told_of_by_every_part_of_a_sweep() {
    use sungaze::frames::{About, Compression, write_exr};
    use sungaze::light::{Planes, Samples};
    let folder = tempfile::tempdir().unwrap();
    let samples =
        Samples::Float((0..16 * 9 * 3).map(|i| if i == 50 { f32::NAN } else { 1.0 }).collect());
    let still = Planes { width: 16, height: 9, count: 3, samples };
    let about = About { white: Some(sungaze::units::Nits(100.0)), ..About::default() };
    write_exr(&folder.path().join("a.exr"), &["R", "G", "B"], &still, Compression::Zip, &about)
        .unwrap();
    let text = "[input]\nframes = \"a.exr\"\nhorizontal_fov_deg = 8\nnon_finite = \"clamp\"\n[sweep]\ndurations_s = [1]\n";
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    for part in [&["--index", "0"][..], &["--merge"], &[]] {
        let output = sungaze(folder.path(), &[&["s.toml", "--out", "o"], part].concat());
        assert_eq!(output.status.code(), Some(3), "{part:?}: {}", told(&output));
    }
}

#[test]
fn a_probe_on_black_has_no_chromaticity_and_its_sweep_finishes() {
    use sungaze::frames::{About, Compression, write_exr};
    use sungaze::light::Planes;
    let folder = tempfile::tempdir().unwrap();
    let about = About { white: Some(sungaze::units::Nits(100.0)), ..About::default() };
    let black = Planes::float(16, 9, 3);
    write_exr(&folder.path().join("a.exr"), &["R", "G", "B"], &black, Compression::Zip, &about)
        .unwrap();
    let text =
        "[input]\nframes = \"a.exr\"\nhorizontal_fov_deg = 8\n[sweep]\ndurations_s = [0, 1]\n";
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    succeeds(folder.path(), &["s.toml", "--out", "o"]);
    succeeds(folder.path(), &["s.toml", "--out", "o", "--merge"]);
    let table = std::fs::read_to_string(folder.path().join("o/sweep.csv")).unwrap();
    assert_eq!(
        table.lines().skip(1).filter(|row| row.contains(",0,0,0,NaN,NaN,")).count(),
        2,
        "{table}"
    );
}

#[test]
fn durations_past_a_methods_limit_are_told_of_once_by_every_part_of_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{SMALL}durations_s = [1, 60, 600]\n[numerics]\nmethod = \"rk4\"\n");
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    for part in [&["--index", "0"][..], &["--merge"], &[]] {
        let said = told(&sungaze(folder.path(), &[&["s.toml", "--out", "o"], part].concat()));
        assert_eq!(said.matches("h lambda = ").count(), 1, "{part:?}: {said}");
        assert!(said.contains("is past the limit 2.7853 of method \"rk4\""), "{said}");
    }
    let exact = sungaze(folder.path(), &["s.toml", "--out", "e", "--set", "numerics.method=exact"]);
    assert!(exact.status.success() && !told(&exact).contains("h lambda"), "{}", told(&exact));
}

#[test]
fn a_case_whose_rows_were_cut_short_is_run_again() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), format!("{SMALL}durations_s = [0, 1, 5]\n"))
        .unwrap();
    succeeds(folder.path(), &["s.toml", "--out", "o"]);
    let whole = files(&folder.path().join("o"));
    let cells = folder.path().join("o/case.0000/cells.csv");
    let rows = std::fs::read_to_string(&cells).unwrap();
    for kept in [0, rows.len() / 2, rows.len() - 3] {
        std::fs::write(&cells, &rows[..kept]).unwrap();
        let merge = sungaze(folder.path(), &["s.toml", "--out", "o", "--merge"]);
        assert_eq!(merge.status.code(), Some(1), "{}", told(&merge));
        succeeds(folder.path(), &["s.toml", "--out", "o"]);
        assert!(files(&folder.path().join("o")) == whole);
    }
}

#[test]
fn tables_as_json_hold_whole_numbers_lists_and_strings_as_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{SMALL}durations_s = [0.5]\n[[sweep.vary]]\nkey = \"numerics.method\"\nvalues = [\"exact\"]\n\
         [[sweep.vary]]\nkey = \"gaze.at\"\nvalues = [[0.5, 0.25]]\n"
    );
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    for arguments in [&["--list"][..], &["--out", "o"]] {
        let output = sungaze(folder.path(), &[&["s.toml", "--json"], arguments].concat());
        let rows: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(rows[0]["case"].is_u64(), "{rows}");
        assert_eq!(rows[0]["numerics.method"], "exact");
        assert_eq!(rows[0]["gaze.at"], serde_json::json!([0.5, 0.25]));
    }
    let again = sungaze(folder.path(), &["s.toml", "--out", "p"]);
    assert_eq!(String::from_utf8_lossy(&again.stdout), "p: 1 case run\n");
}
