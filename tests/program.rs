//! The program as a user meets it: outputs, exit codes, messages.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use sungaze::frames::{About, Compression, write_exr};
use sungaze::light::{Planes, Samples};
use sungaze::units::Nits;

fn sungaze(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sungaze"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the program starts")
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder for the test")
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap_or(-1)
}

fn told(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!text.contains("panicked") && !text.contains("RUST_BACKTRACE"), "{text}");
    text
}

const SMALL: [&str; 6] = [
    "--set",
    "input.width=64",
    "--set",
    "time.times_s=[0, 0.5, 1, 2]",
    "--set",
    "output.compression=zip",
];

fn run_small(folder: &Path, more: &[&str]) -> Output {
    sungaze(folder, &[&["run", "--quiet"], &SMALL[..], more].concat())
}

fn picture(path: &Path, width: usize, height: usize, rgb: [f32; 3]) {
    let mut planes = Planes::float(width, height, 3);
    if let Samples::Float(samples) = &mut planes.samples {
        for (i, v) in samples.iter_mut().enumerate() {
            *v = rgb[i / width % 3];
        }
    }
    let about = About { white: Some(Nits(1000.0)), ..About::default() };
    write_exr(path, &["R", "G", "B"], &planes, Compression::Zip, &about).unwrap();
}

#[test]
fn a_run_leaves_what_its_contract_says() {
    let folder = folder();
    let output = run_small(folder.path(), &["--out", "o", "--json"]);
    assert_eq!(code(&output), 0, "{}", told(&output));
    let o = folder.path().join("o");
    for name in [
        "seen.0001.exr",
        "display.0003.png",
        "state.exr",
        "trace.csv",
        "probes.csv",
        "probes.svg",
        "report.json",
        "report.html",
    ] {
        assert!(o.join(name).metadata().is_ok_and(|m| m.len() > 0), "{name}");
    }
    assert_eq!(
        std::fs::read_dir(&o).unwrap().count(),
        4 + 4 + 7,
        "nothing else, no checkpoint, no temporary file"
    );
    let trace = std::fs::read_to_string(o.join("trace.csv")).unwrap();
    assert!(trace.starts_with(
        "frame,time_s,duration_s,gaze_x,gaze_y,adapting_cd_m2,pupil_mm,sce_L,sce_M,sce_S,"
    ));
    assert_eq!(trace.lines().count(), 4);
    let probes = std::fs::read_to_string(o.join("probes.csv")).unwrap();
    assert!(probes.starts_with(
        "frame,time_s,probe,I_L,I_M,I_S,p_L,p_M,p_S,X,Y,Z,x,y,pupil_mm,lost_L,lost_M,lost_S\n\
             1,0.5,gaze,"
    ));
    let report: serde_json::Value =
        serde_json::from_slice(&output.stdout).expect("stdout is the report");
    for key in [
        "config",
        "version",
        "constants",
        "plan",
        "check",
        "frames",
        "inputs",
        "results",
        "warnings",
        "timing",
    ] {
        assert!(!report[key].is_null(), "{key}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let folder = folder();
    for threads in ["1", "2", "5"] {
        let output = run_small(folder.path(), &["--out", threads, "--threads", threads]);
        assert_eq!(code(&output), 0, "{}", told(&output));
    }
    for name in
        ["seen.0003.exr", "display.0002.png", "state.exr", "trace.csv", "probes.csv", "probes.svg"]
    {
        let bytes = |threads: &str| std::fs::read(folder.path().join(threads).join(name)).unwrap();
        assert_eq!(bytes("1"), bytes("2"), "{name}");
        assert_eq!(bytes("1"), bytes("5"), "{name}");
    }
}

#[test]
fn an_eye_that_is_not_modelled_gives_back_the_files_own_pixels() {
    let folder = folder();
    picture(&folder.path().join("in.exr"), 8, 4, [0.3, -0.01, 70000.0]);
    let set = [
        "--set",
        "input.frames=in.exr",
        "--set",
        "input.horizontal_fov_deg=8",
        "--set",
        "numerics.model=none",
        "--set",
        "time.duration_s=0.04",
    ];
    let output = sungaze(folder.path(), &[&["run", "--quiet", "--out", "o"], &set[..]].concat());
    assert_eq!(code(&output), 0, "{}", told(&output));
    let options = sungaze::frames::ReadOptions::default();
    let read = |name: &str| {
        let footage = sungaze::frames::open(&[folder.path().join(name)], &options).unwrap();
        footage.read(0, None, None).unwrap().planes
    };
    assert_eq!(read("in.exr"), read("o/seen.0001.exr"));
}

#[test]
fn a_folder_with_something_in_it_is_refused_resumed_or_overwritten() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("o")).unwrap();
    std::fs::write(folder.path().join("o/mine.txt"), "mine").unwrap();
    for flag in [&[][..], &["--resume"], &["--overwrite"]] {
        let refused = run_small(folder.path(), &[&["--out", "o"], flag].concat());
        assert_eq!(code(&refused), 2);
        assert!(told(&refused).contains("mine.txt"), "{}", told(&refused));
    }
    std::fs::remove_file(folder.path().join("o/mine.txt")).unwrap();
    assert_eq!(code(&run_small(folder.path(), &["--out", "o"])), 0);
    std::fs::write(folder.path().join("o/mine.txt"), "mine").unwrap();
    let refused = run_small(folder.path(), &["--out", "o"]);
    assert_eq!(code(&refused), 2);
    assert!(told(&refused).contains("--resume") && told(&refused).contains("--overwrite"));
    assert_eq!(code(&run_small(folder.path(), &["--out", "o", "--overwrite"])), 0);
    assert_eq!(std::fs::read_to_string(folder.path().join("o/mine.txt")).unwrap(), "mine");
    let again = run_small(folder.path(), &["--out", "o", "--resume"]);
    assert_eq!(code(&again), 0, "a complete run has nothing to resume");
    let changed = run_small(folder.path(), &["--out", "o", "--resume", "--set", "observer.age=31"]);
    assert_eq!(code(&changed), 2);
    assert!(told(&changed).contains("observer.age"), "{}", told(&changed));
}

#[test]
fn a_mistake_costs_nothing_of_an_earlier_run() {
    let folder = folder();
    assert_eq!(code(&run_small(folder.path(), &["--out", "o"])), 0);
    let files = || std::fs::read_dir(folder.path().join("o")).unwrap().count();
    let before = files();
    for mistake in [
        "output.compression=tar",
        "numerics.method=leapfrog",
        "observer.start=nowhere.exr",
        "gaze.path=nowhere.csv",
    ] {
        let output = run_small(folder.path(), &["--out", "o", "--overwrite", "--set", mistake]);
        assert_ne!(code(&output), 0, "{mistake}");
        assert_eq!(files(), before, "{mistake}");
    }
}

#[test]
fn a_value_that_is_no_word_is_told_what_is_accepted_in_the_words_of_users() {
    let folder = folder();
    for value in ["false", "3", "[1]"] {
        let set = format!("output.seen={value}");
        let refused = run_small(folder.path(), &["--out", "o", "--set", &set]);
        let told = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(told.contains("output.seen: accepted: a word"), "{told}");
        assert_eq!(code(&refused), 2);
    }
}

#[test]
fn bad_frames_that_a_policy_lets_go_on_are_counted_and_exit_with_three() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for number in [1, 2, 4] {
        picture(&at(&format!("f.{number:04}.exr")), 4, 2, [1.0, 2.0, 1.0]);
    }
    picture(&at("inf.exr"), 4, 2, [1.0, f32::INFINITY, f32::NAN]);
    let run = |more: &[&str]| {
        let set = ["run", "--quiet", "--json", "--set", "input.horizontal_fov_deg=8"];
        sungaze(folder.path(), &[&set[..], more].concat())
    };
    let gap = run(&["--set", "input.frames=f.####.exr", "--out", "gap"]);
    assert_eq!(code(&gap), 2, "{}", told(&gap));
    assert!(told(&gap).contains("3"), "the missing number is named: {}", told(&gap));
    let held =
        run(&["--set", "input.frames=f.####.exr", "--set", "input.missing=hold", "--out", "held"]);
    assert_eq!(code(&held), 3, "{}", told(&held));
    assert_eq!(told(&held).trim().lines().count(), 1, "one warning: {}", told(&held));
    assert!(at("held/seen.0003.exr").exists(), "one output for the missing number");
    let trace = std::fs::read_to_string(at("held/trace.csv")).unwrap();
    assert!(
        trace.lines().nth(4).is_some_and(|row| row.starts_with("4,0.1666")),
        "time follows the numbers: {trace}"
    );
    let set = [
        "--set",
        "input.frames=inf.exr",
        "--set",
        "time.duration_s=0.04",
        "--set",
        "input.non_finite=clamp",
    ];
    let clamped = run(&[&set[..], &["--out", "clamped"]].concat());
    assert_eq!(code(&clamped), 3, "{}", told(&clamped));
    let report: serde_json::Value = serde_json::from_slice(&clamped.stdout).unwrap();
    assert_eq!(
        (&report["frames"]["infinite_samples"], &report["frames"]["nan_samples"]),
        (&8.into(), &8.into())
    );
}

#[test]
fn a_run_that_takes_a_method_past_its_limit_says_which_frame_and_by_how_much() {
    let folder = folder();
    let set = [
        "--out",
        "o",
        "--json",
        "--set",
        "numerics.method=rk4",
        "--set",
        "numerics.model=tracked",
        "--set",
        "time.times_s=[0, 60]",
    ];
    let output = run_small(folder.path(), &set);
    let (warned, report) = (told(&output), String::from_utf8_lossy(&output.stdout).into_owned());
    for text in [warned, report] {
        assert!(
            text.contains("frame 1: h lambda = ") && text.contains("past the limit 2.7853"),
            "{text}"
        );
    }
}

#[test]
fn two_runs_do_not_write_into_one_folder_at_once() {
    let folder = folder();
    let long = [
        "run",
        "--quiet",
        "--set",
        "input.width=64",
        "--set",
        "time.fps=1",
        "--set",
        "time.duration_s=100000",
        "--out",
        "o",
    ];
    let mut first = Command::new(env!("CARGO_BIN_EXE_sungaze"))
        .current_dir(folder.path())
        .args(long)
        .spawn()
        .unwrap();
    let begun = std::time::Instant::now();
    while !folder.path().join("o/seen.0001.exr").exists() && begun.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let second = run_small(folder.path(), &["--out", "o", "--overwrite"]);
    first.kill().unwrap();
    first.wait().unwrap();
    assert_eq!(code(&second), 2, "{}", told(&second));
    assert!(told(&second).contains("another run"), "{}", told(&second));
    assert_eq!(
        code(&run_small(folder.path(), &["--out", "o", "--overwrite"])),
        0,
        "a killed run holds nothing"
    );
}

/// A configuration, the exit code it deserves and what the message must name.
const WRONG: &[(&str, i32, &[&str])] = &[
    ("[observer]\nagee = 30\n", 2, &["c.toml:2", "agee"]),
    ("[observer]\nage = \"old\"\n", 2, &["c.toml:2", "observer.age"]),
    ("[observer]\n\nage = 300\n", 2, &["c.toml:3", "observer.age", "300", "20 to 80"]),
    (
        "[observer]\npupil = \"round\"\n",
        2,
        &["c.toml:2", "observer.pupil", "watson-yellott", "moon-spencer"],
    ),
    ("[observer]\npreset = \"papper\"\n", 2, &["c.toml:2", "observer.preset", "papper", "paper"]),
    ("[observer]\nconstants = \"mine\"\n", 2, &["observer.constants", "wyszecki-stiles"]),
    ("[observer]\npupil = \"fixed\"\n", 2, &["observer.pupil_mm", "required"]),
    ("[observer]\ntau_s = [120, 120, nan]\n", 2, &["observer.tau_s", "NaN"]),
    ("[numerics]\nmethod = \"leapfrog\"\n", 2, &["numerics.method", "exact", "forward-euler"]),
    ("[time]\nfps = 24\ninterval_s = 1\n", 2, &["time.interval_s", "excludes", "time.fps"]),
    ("[time]\ntimes_s = [0, 2, 1]\n", 2, &["c.toml:2", "time.times_s", "rise"]),
    (
        "[input]\nframes = \"nowhere.####.exr\"\nhorizontal_fov_deg = 40\n",
        2,
        &["c.toml:2", "input.frames", "nowhere.####.exr"],
    ),
    ("[input]\nframes = \"empty.exr\"\nhorizontal_fov_deg = 40\n", 1, &["empty.exr"]),
    ("[input]\nframes = \"text.exr\"\nhorizontal_fov_deg = 40\n", 1, &["text.exr"]),
    ("[input]\nframes = \"cut.exr\"\nhorizontal_fov_deg = 40\n", 1, &["cut.exr"]),
    ("[input]\nframes = \"nan.exr\"\nhorizontal_fov_deg = 40\n", 1, &["nan.exr", "NaN"]),
    ("[input]\nframes = \"plain.exr\"\n", 2, &["input.horizontal_fov_deg", "required"]),
    (
        "[input]\nframes = \"white.exr\"\nhorizontal_fov_deg = 40\n",
        2,
        &["input.white_cd_m2", "required", "179"],
    ),
    (
        "[input]\nframes = \"plain.exr\"\nhorizontal_fov_deg = 40\nmax_pixels = 3\n",
        1,
        &["plain.exr", "max_pixels"],
    ),
    ("[input]\nscene = \"moonrise\"\n", 2, &["input.scene", "sunset"]),
    ("[display]\nhighlights = 2\n", 2, &["display.highlights", "0 to 1"]),
    ("[output]\ncompression = \"tar\"\n", 2, &["output.compression", "zip"]),
    ("[[output.probe]]\nname = \"a,b\"\nat = [0.5, 0.5]\n", 2, &["output.probe.name"]),
    ("[[output.probe]]\nname = \"a\"\nat = [0.5, 1.5]\n", 2, &["output.probe.at", "1.5"]),
    ("[gaze]\nat = \"darkest\"\n", 2, &["c.toml:2", "gaze.at", "brightest"]),
    ("[gaze]\npath = \"nowhere.csv\"\n", 2, &["c.toml:2", "gaze.path", "nowhere.csv"]),
    ("this is not TOML\n", 2, &["c.toml:1"]),
];

#[test]
fn every_mistake_gets_one_message_that_names_it() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(&at("plain.exr"), 4, 2, [1.0; 3]);
    picture(&at("nan.exr"), 4, 2, [1.0, f32::NAN, 1.0]);
    write_exr(
        &at("white.exr"),
        &["R", "G", "B"],
        &Planes::float(4, 2, 3),
        Compression::None,
        &About::default(),
    )
    .unwrap();
    std::fs::write(at("empty.exr"), "").unwrap();
    std::fs::write(at("text.exr"), "this is no picture at all, only text").unwrap();
    let whole = std::fs::read(at("plain.exr")).unwrap();
    std::fs::write(at("cut.exr"), &whole[..whole.len() - 20]).unwrap();
    for (toml, expected, names) in WRONG {
        std::fs::write(at("c.toml"), toml).unwrap();
        let output =
            sungaze(folder.path(), &["run", "c.toml", "--quiet", "--out", "o", "--overwrite"]);
        let message = told(&output);
        assert_eq!(code(&output), *expected, "{toml}: {message}");
        assert_eq!(message.trim().lines().count(), 1, "one message: {message}");
        for name in *names {
            assert!(message.contains(name), "{toml} should name {name}: {message}");
        }
        let left: Vec<PathBuf> =
            std::fs::read_dir(at("o")).into_iter().flatten().map(|e| e.unwrap().path()).collect();
        assert!(
            left.iter().all(|p| !p.to_string_lossy().ends_with(".exr")),
            "{toml} left {left:?}"
        );
    }
}

#[test]
fn the_command_lines_own_mistakes_exit_with_two() {
    let folder = folder();
    for arguments in [
        &["run", "--set", "observer.age"][..],
        &["run", "--set", "observer.agee=3"],
        &["run", "--threads", "0"],
        &["run", "--bogus"],
        &["fly"],
        &["run", "--resume", "--overwrite"],
    ] {
        let output = sungaze(folder.path(), arguments);
        assert_eq!(code(&output), 2, "{arguments:?}: {}", told(&output));
    }
}

#[test]
fn a_missing_configuration_is_named() {
    let folder = folder();
    let output = sungaze(folder.path(), &["run", "nowhere.toml"]);
    assert_eq!(code(&output), 2);
    assert!(told(&output).contains("nowhere.toml"));
}

/// The program with its stdout and stderr going where they cannot be written.
#[cfg(target_os = "linux")]
fn unheard(folder: &Path, arguments: &[&str], [out, err]: [&str; 2]) -> i32 {
    let to = |name: &str| match name {
        // A pipe whose reader has gone away.
        "closed" => Stdio::from(std::io::pipe().unwrap().1),
        file => Stdio::from(std::fs::OpenOptions::new().write(true).open(file).unwrap()),
    };
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    command.current_dir(folder).args(arguments).stdout(to(out)).stderr(to(err));
    command.status().unwrap().code().unwrap_or(-1)
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_pipe_or_a_full_log_ends_no_run() {
    let folder = folder();
    let run = |out: &str, more: &[&str], to| {
        unheard(folder.path(), &[&["run", "--out", out], &SMALL[..], more].concat(), to)
    };
    assert_eq!(run("closed", &[], ["closed", "closed"]), 0);
    assert_eq!(run("full", &[], ["/dev/null", "/dev/full"]), 0);
    for out in ["closed", "full"] {
        assert!(folder.path().join(out).join("report.json").exists(), "{out}");
    }
    assert_eq!(
        run("o", &["--set", "observer.agee=3"], ["/dev/null", "closed"]),
        2,
        "the mistake keeps its code"
    );
    assert_eq!(
        run("p", &["--json"], ["/dev/full", "closed"]),
        1,
        "a result that nobody gets is a failure"
    );
    assert_eq!(unheard(folder.path(), &["inspect", "nothing.exr"], ["closed", "/dev/full"]), 1);
}

#[test]
fn nothing_prints_but_the_one_writer() {
    fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() { sources(&path, found) } else { found.push(path) }
        }
    }
    let mut files = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
    assert!(files.len() > 50, "{files:?}");
    for file in files.iter().filter(|file| file.extension().is_some_and(|e| e == "rs")) {
        let text = std::fs::read_to_string(file).unwrap();
        for print in ["print!", "println!", "dbg!", "std::process::exit"] {
            assert!(!text.contains(print), "{} has {print}, which panics or exits", file.display());
        }
    }
}

#[test]
fn frames_are_run_without_a_configuration_and_what_is_missing_is_asked_for_at_once() {
    let folder = folder();
    let plain = |name: &str| {
        let planes = Planes::float(4, 2, 3);
        let path = folder.path().join(name);
        let about = About::default();
        write_exr(&path, &["R", "G", "B"], &planes, Compression::Zip, &about).unwrap();
    };
    ["sun.0001.exr", "sun.0002.exr", "a still.exr"].into_iter().for_each(plain);
    let asked = sungaze(folder.path(), &["run", "a still.exr"]);
    assert_eq!(code(&asked), 2);
    for words in ["--fov DEG", "--white CD_M2", "sungaze run 'a still.exr' --fov 40 --white 100"] {
        assert!(told(&asked).contains(words), "{}", told(&asked));
    }
    let light = ["--fov", "8", "--white", "1000", "--quiet"];
    let still = [&["run", "a still.exr", "--for", "0.5", "--fps", "4"], &light[..]].concat();
    assert_eq!(code(&sungaze(folder.path(), &still)), 0);
    assert!(folder.path().join("out/a still/seen.0002.exr").exists());
    assert!(!folder.path().join("out/a still/seen.0003.exr").exists());
    let sequence = [&["run", "sun.####.exr"], &light[..]].concat();
    assert_eq!(code(&sungaze(folder.path(), &sequence)), 0);
    let trace = std::fs::read_to_string(folder.path().join("out/sun/trace.csv")).unwrap();
    assert_eq!(trace.lines().count(), 3);
    let planned = sungaze(folder.path(), &[&["plan", "sun.####.exr"], &light[..]].concat());
    assert_eq!(code(&planned), 0, "{}", told(&planned));
    let asked = sungaze(folder.path(), &["plan", "sun.####.exr", "--white", "3"]);
    assert!(told(&asked).contains("sungaze plan 'sun.####.exr' --fov 40"), "{}", told(&asked));
}

#[test]
fn only_the_pictures_of_the_range_are_written_and_the_tables_have_all_rows() {
    let folder = folder();
    assert_eq!(code(&run_small(folder.path(), &["--out", "all"])), 0);
    let some = run_small(folder.path(), &["--out", "some", "--set", "output.range=3"]);
    assert_eq!(code(&some), 0, "{}", told(&some));
    let read = |name: &str| std::fs::read(folder.path().join(name)).ok();
    for name in ["display.0003.png", "state.exr", "trace.csv", "probes.csv"] {
        let (some, all) = (read(&format!("some/{name}")), read(&format!("all/{name}")));
        assert!(name == "state.exr" || some == all, "{name}");
        assert!(some.is_some());
    }
    assert!(folder.path().join("some/seen.0003.exr").exists());
    assert!(read("some/seen.0002.exr").is_none() && read("some/seen.start.exr").is_none());
    let none = run_small(folder.path(), &["--out", "none", "--set", "output.range=7-9"]);
    assert_eq!(code(&none), 2);
    assert!(told(&none).contains("the frames are 1 to 3"), "{}", told(&none));
}

#[test]
fn a_part_of_a_sequence_keeps_the_time_and_the_gaze_of_the_whole() {
    let folder = folder();
    for (number, red) in (1001..).zip([3.0, 9.0, 0.5, 40.0, 2.0]) {
        let path = folder.path().join(format!("a.{number}.exr"));
        picture(&path, 12, 6, [red, 7.0 - red / 8.0, 2.0]);
    }
    std::fs::write(folder.path().join("gaze.csv"), "time_s,x,y\n0,0.2,0.3\n5,0.9,0.6\n").unwrap();
    let run = |out: &str, more: &[&str]| {
        let of_all = ["run", "a.####.exr", "--fov", "8", "--fps", "1", "--quiet", "--out", out];
        let keys = ["--set", "gaze.path=gaze.csv", "--set", "output.state=every"];
        let output = sungaze(folder.path(), &[&of_all, &keys[..], more].concat());
        assert_eq!(code(&output), 0, "{}", told(&output));
    };
    run("all", &[]);
    run("some", &["--set", "output.range=1004-1005"]);
    let read = |name: String| std::fs::read(folder.path().join(name)).ok();
    let seen = |name: String| {
        let footage = sungaze::frames::open(&[folder.path().join(name)], &Default::default());
        footage.unwrap().read(0, None, None).unwrap().planes
    };
    for number in [1004, 1005] {
        let name = format!("display.{number}.png");
        assert_eq!(read(format!("some/{name}")), read(format!("all/{name}")));
        for kind in ["seen", "state"] {
            let name = format!("{kind}.{number}.exr");
            assert!(read(format!("some/{name}")).is_some(), "{name}");
        }
        let name = format!("seen.{number}.exr");
        assert_eq!(seen(format!("some/{name}")), seen(format!("all/{name}")));
    }
    assert!(read("some/display.1003.png".into()).is_none());
    for table in ["trace.csv", "probes.csv"] {
        assert_eq!(read(format!("some/{table}")), read(format!("all/{table}")));
    }
}

#[test]
fn a_jump_of_gaze_at_the_start_of_a_frame_shows_in_that_frame_and_not_in_the_one_before() {
    let folder = folder();
    for number in 1048..=1051 {
        picture(&folder.path().join(format!("a.{number}.exr")), 12, 6, [1.0, 1.0, 1.0]);
    }
    let by_time = "time_s,x,y\n0,0.25,0.5\n1.9999,0.25,0.5\n2,0.75,0.5\n";
    let by_frame = "frame,x,y\n1049,0.25,0.5\n1050,0.75,0.5\n";
    for (out, path) in [("time", by_time), ("frame", by_frame)] {
        std::fs::write(folder.path().join("gaze.csv"), path).unwrap();
        let of_all = ["run", "a.####.exr", "--fov", "8", "--fps", "1", "--quiet", "--out", out];
        let output =
            sungaze(folder.path(), &[&of_all[..], &["--set", "gaze.path=gaze.csv"]].concat());
        assert_eq!(code(&output), 0, "{}", told(&output));
        let trace = std::fs::read_to_string(folder.path().join(out).join("trace.csv")).unwrap();
        let gaze = trace.lines().skip(1).map(|row| row.split(',').nth(3).unwrap().to_owned());
        assert_eq!(gaze.collect::<Vec<_>>(), ["0.25", "0.25", "0.75", "0.75"], "by {out}");
    }
}

#[test]
fn a_scene_as_rgb_puts_the_trolands_of_its_spectra_on_the_retina() {
    let folder = folder();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/sunset_mitsuba.exr");
    let places = "[{ name = \"sky\", at = [0.1, 0.1] }, { name = \"sun\", at = [0.5, 0.5] }, \
                  { name = \"limb\", at = [0.5, 0.52] }, { name = \"sea\", at = [0.3, 0.9] }]";
    let read = |frames: &str, more: &[&str], out: &str| -> Vec<Vec<f64>> {
        let run =
            ["run", frames, "--fov", "8", "--for", "1", "--fps", "1", "--quiet", "--out", out];
        let probes = format!("output.probe={places}");
        let keys = ["--set", "numerics.model=none", "--set", "optics.psf=none", "--set", &probes];
        let output = sungaze(folder.path(), &[&run[..], &keys, more].concat());
        assert_eq!(code(&output), 0, "{}", told(&output));
        let table = std::fs::read_to_string(folder.path().join(out).join("probes.csv")).unwrap();
        let rows = table.lines().skip(1).map(|row| row.split(',').skip(3));
        rows.map(|row| row.map(|cell| cell.parse().unwrap()).collect()).collect()
    };
    let spectra = read(scene.to_str().unwrap(), &[], "spectra");
    let rgb = read("spectra/seen.0001.exr", &["--white", "1"], "rgb");
    assert_eq!((spectra.len(), rgb.len()), (4, 4));
    for (spectral, rgb) in spectra.iter().zip(&rgb) {
        let apart = |i: usize| (rgb[i] / spectral[i] - 1.0).abs();
        // Only the Stiles-Crawford effect can tell the spectra apart.
        assert!((0..3).all(|i| apart(i) < 2e-3), "trolands {rgb:?} {spectral:?}");
        assert!((6..9).all(|i| apart(i) < 1e-6), "XYZ {rgb:?} {spectral:?}");
    }
}

#[test]
fn marks_are_drawn_at_the_gaze_in_display_pictures_and_nowhere_else() {
    let folder = folder();
    let gaze = ["--set", "gaze.at=[0.25, 0.5]"];
    assert_eq!(code(&run_small(folder.path(), &[&gaze[..], &["--out", "bare"]].concat())), 0);
    let drawn = [&gaze[..], &["--set", "output.marks=true", "--out", "marked"]].concat();
    assert_eq!(code(&run_small(folder.path(), &drawn)), 0);
    let read = |name: String| std::fs::read(folder.path().join(name)).unwrap();
    let png = |name: String| sungaze::frames::decode_png(&read(name)).unwrap();
    let seen = |name: String| {
        let footage = sungaze::frames::open(&[folder.path().join(name)], &Default::default());
        footage.unwrap().read(0, None, None).unwrap().planes
    };
    for name in ["start", "0001", "0003"] {
        let [bare, marked] = ["bare", "marked"].map(|out| seen(format!("{out}/seen.{name}.exr")));
        assert_eq!(bare, marked);
        let [bare, marked] = ["bare", "marked"].map(|out| png(format!("{out}/display.{name}.png")));
        let (width, height) = (bare.0, bare.1);
        assert_eq!((marked.0, marked.1), (width, height));
        let changed =
            (0..width * height).filter(|i| bare.2[3 * i..][..3] != marked.2[3 * i..][..3]);
        let changed: Vec<[usize; 2]> = changed.map(|i| [i % width, i / width]).collect();
        let [cross, clock]: [Vec<[usize; 2]>; 2] = [true, false].map(|above| {
            changed.iter().copied().filter(|at| (at[1] + 14 < height) == above).collect()
        });
        let mean = |i: usize| cross.iter().map(|at| at[i] as f64).sum::<f64>() / cross.len() as f64;
        let at = [0.25 * width as f64 - 0.5, 0.5 * height as f64 - 0.5];
        // A black edge over black changes nothing: half a pixel.
        assert!((0..2).all(|i| (mean(i) - at[i]).abs() < 0.5), "{} {} {at:?}", mean(0), mean(1));
        assert!(cross.iter().all(|p| (0..2).all(|i| (p[i] as f64 - at[i]).abs() < 7.0)));
        assert!(!clock.is_empty() && clock.iter().all(|at| at[0] < 50));
    }
    for table in ["trace.csv", "probes.csv"] {
        assert_eq!(read(format!("bare/{table}")), read(format!("marked/{table}")));
    }
}

#[test]
fn the_start_is_the_light_itself_before_anything_has_bleached() {
    let folder = folder();
    picture(&folder.path().join("in.exr"), 8, 4, [3.0, 2.0, 70.0]);
    let run = |out: &str, more: &[&str]| {
        let frames = ["run", "in.exr", "--fov", "8", "--for", "5", "--fps", "1", "--quiet"];
        let output = sungaze(folder.path(), &[&frames, more, &["--out", out]].concat());
        assert_eq!(code(&output), 0, "{}", told(&output));
    };
    let read = |name: &str| {
        let paths = [folder.path().join(name)];
        let footage = sungaze::frames::open(&paths, &Default::default()).unwrap();
        footage.read(0, None, None).unwrap().planes
    };
    for model in ["auto", "tracked", "steady", "none"] {
        run(model, &["--set", &format!("numerics.model={model}")]);
        assert_eq!(read("in.exr"), read(&format!("{model}/seen.start.exr")), "{model}");
    }
    assert_ne!(read("in.exr"), read("steady/seen.0001.exr"));
    run("adapted", &["--set", "observer.start=adapted"]);
    assert_eq!(read("adapted/seen.start.exr"), read("steady/seen.0001.exr"));
}

#[test]
fn completions_are_printed_for_every_shell() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = sungaze(folder.path(), &["completions", shell]);
        assert_eq!(code(&output), 0);
        assert!(String::from_utf8_lossy(&output.stdout).contains("sungaze"));
    }
}
