//! Runs that go on after the world has changed: either they are what they would have been, or they
//! are refused with the name of what changed. Nobody's files are touched.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use sungaze::frames::{About, Compression, write_exr};
use sungaze::light::{Planes, Samples};
use sungaze::units::Nits;

fn sungaze(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    command.current_dir(folder).args(arguments).output().expect("the program starts")
}

fn told(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!text.contains("panicked"), "{text}");
    text
}

fn picture(path: &Path, light: f32, size: [usize; 2]) {
    let mut planes = Planes::float(size[0], size[1], 3);
    if let Samples::Float(samples) = &mut planes.samples {
        samples.iter_mut().enumerate().for_each(|(i, v)| *v = light * (1 + i % 7) as f32);
    }
    let about = About { white: Some(Nits(1000.0)), ..About::default() };
    write_exr(path, &["R", "G", "B"], &planes, Compression::Zip, &about).unwrap();
}

/// A folder with frames 1 to `frames`, a gaze path and a configuration of them, and a run `o`.
struct Stage(tempfile::TempDir);

impl Stage {
    fn new(frames: u32) -> Stage {
        let stage = Stage(tempfile::tempdir().unwrap());
        (1..=frames).for_each(|number| stage.frame(number));
        std::fs::write(stage.at("gaze.csv"), "time_s,x,y\n0,0.5,0.5\n1,0.6,0.4\n").unwrap();
        let toml = "[input]\nframes = \"a.####.exr\"\nhorizontal_fov_deg = 8\n\
                    [time]\nfps = 24\n[gaze]\npath = \"gaze.csv\"\n\
                    [numerics]\nmodel = \"tracked\"\n[output]\ncheckpoint_s = 0\n";
        std::fs::write(stage.at("c.toml"), toml).unwrap();
        stage
    }

    /// A run of six frames that stopped before its fifth, which was damaged, and is whole again.
    fn stopped() -> Stage {
        let stage = Stage::new(6);
        let whole = std::fs::read(stage.name(5)).unwrap();
        std::fs::write(stage.name(5), &whole[..200]).unwrap();
        let output = stage.run(&[]);
        assert_eq!(output.status.code(), Some(1), "{}", told(&output));
        assert!(stage.at("o/checkpoint.sungaze").exists());
        std::fs::write(stage.name(5), whole).unwrap();
        stage
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn name(&self, number: u32) -> PathBuf {
        self.at(&format!("a.{number:04}.exr"))
    }

    fn frame(&self, number: u32) {
        picture(&self.name(number), number as f32, [16, 10]);
    }

    fn run(&self, more: &[&str]) -> Output {
        sungaze(self.0.path(), &[&["run", "c.toml", "--quiet", "--out", "o"], more].concat())
    }

    /// Everything in the folder, by name, but for the report with its times.
    fn files(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let mut found = Vec::new();
        for folder in [self.at(""), self.at("o")] {
            for entry in std::fs::read_dir(folder).into_iter().flatten() {
                let path = entry.unwrap().path();
                if path.is_file() && !path.ends_with("report.json") {
                    found.push((path.strip_prefix(self.0.path()).unwrap().to_owned(), path));
                }
            }
        }
        found.sort();
        found.into_iter().map(|(name, path)| (name, std::fs::read(path).unwrap())).collect()
    }
}

/// Changes a stage, resumes, and holds that the refusal names what changed and touches nothing.
fn refused(change: impl FnOnce(&Stage), names: &[&str]) {
    let stage = Stage::stopped();
    change(&stage);
    let before = stage.files();
    let output = stage.run(&["--resume"]);
    let message = told(&output);
    assert_eq!(output.status.code(), Some(2), "{names:?}: {message}");
    assert!(names.iter().all(|name| message.contains(name)), "{names:?}: {message}");
    assert!(before == stage.files(), "a refusal touches nothing: {names:?}");
}

#[test]
fn a_run_that_stopped_at_a_bad_frame_resumes_to_the_bytes_of_one_that_never_stopped() {
    let (whole, stopped) = (Stage::new(6), Stage::stopped());
    assert_eq!(whole.run(&[]).status.code(), Some(0));
    let resumed = stopped.run(&["--resume", "--threads", "1"]);
    assert_eq!(resumed.status.code(), Some(0), "{}", told(&resumed));
    let names = |stage: &Stage| stage.files().into_iter().map(|file| file.0).collect::<Vec<_>>();
    assert_eq!(names(&whole), names(&stopped));
    let (whole, stopped) = (whole.files(), stopped.files());
    for (a, b) in whole.iter().zip(&stopped) {
        assert!(a == b, "{}", a.0.display());
    }
}

#[test]
fn frames_that_were_done_and_are_gone_new_larger_or_changed_are_refused_by_name() {
    let remove = |stage: &Stage, number| std::fs::remove_file(stage.name(number)).unwrap();
    refused(|stage| remove(stage, 1), &["frame 1", "not there"]);
    refused(|stage| (3..=6).for_each(|n| remove(stage, n)), &["frame 3"]);
    refused(|stage| (5..=6).for_each(|n| remove(stage, n)), &["still to come"]);
    refused(|stage| stage.frame(0), &["frame 0", "new"]);
    refused(|stage| picture(&stage.name(2), 0.01, [16, 10]), &["frame 2", "a.0002.exr"]);
    let larger = |stage: &Stage| (1..=6).for_each(|n| picture(&stage.name(n), 1.0, [32, 20]));
    refused(larger, &["frame 1", "bytes"]);
}

#[test]
fn a_changed_table_and_lost_results_are_refused_by_name() {
    let gaze = |stage: &Stage| std::fs::write(stage.at("gaze.csv"), "time_s,x,y\n0,0.1,0.5\n");
    refused(|stage| gaze(stage).unwrap(), &["gaze.csv"]);
    let lost = |stage: &Stage| std::fs::remove_file(stage.at("o/seen.0002.exr"));
    refused(|stage| lost(stage).unwrap(), &["seen.0002.exr"]);
}

#[test]
fn a_table_that_is_shorter_than_the_checkpoint_says_is_refused_and_not_padded() {
    let stage = Stage::stopped();
    let trace = std::fs::read(stage.at("o/trace.csv")).unwrap();
    std::fs::write(stage.at("o/trace.csv"), &trace[..300]).unwrap();
    let output = stage.run(&["--resume"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(told(&output).contains("trace.csv: has lost rows"), "{}", told(&output));
    assert_eq!(std::fs::read(stage.at("o/trace.csv")).unwrap(), &trace[..300]);
}

#[test]
fn a_sequence_that_has_grown_goes_on() {
    let (whole, grown) = (Stage::new(8), Stage::stopped());
    (7..=8).for_each(|number| grown.frame(number));
    for stage in [&whole, &grown] {
        let output = stage.run(&["--resume"]);
        assert_eq!(output.status.code(), Some(0), "{}", told(&output));
    }
    assert!(whole.files() == grown.files());
    grown.frame(9);
    whole.frame(9);
    let again = sungaze(grown.0.path(), &["run", "c.toml", "--out", "o", "--resume"]);
    assert!(told(&again).contains("frame 9 is new"), "{}", told(&again));
    assert_eq!(whole.run(&["--overwrite"]).status.code(), Some(0));
    assert!(whole.files() == grown.files());
    let complete = sungaze(grown.0.path(), &["run", "c.toml", "--out", "o", "--resume"]);
    assert!(String::from_utf8_lossy(&complete.stdout).contains("complete already"));
}

#[test]
fn a_complete_run_of_frames_that_have_changed_since_is_not_called_complete() {
    let stage = Stage::new(3);
    assert_eq!(stage.run(&[]).status.code(), Some(0));
    picture(&stage.name(2), 0.5, [16, 10]);
    let output = stage.run(&["--resume"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(told(&output).contains("frame 2"), "{}", told(&output));
}

#[test]
fn a_damaged_or_foreign_checkpoint_is_refused() {
    let stage = Stage::stopped();
    let checkpoint = stage.at("o/checkpoint.sungaze");
    let bytes = std::fs::read(&checkpoint).unwrap();
    let resumed = |bytes: &[u8]| {
        std::fs::write(&checkpoint, bytes).unwrap();
        let output = stage.run(&["--resume"]);
        assert!(told(&output).contains("checkpoint.sungaze"), "{}", told(&output));
        output.status.code()
    };
    assert_eq!(resumed(b""), Some(1));
    assert_eq!(resumed(&bytes[..bytes.len() / 2]), Some(1));
    for at in [0, 20, bytes.len() / 2, bytes.len() - 1] {
        let mut changed = bytes.clone();
        changed[at] ^= 1;
        assert_eq!(resumed(&changed), Some(1), "byte {at}");
    }
    // Another run's, whole.
    let other = Stage::stopped();
    let set = ["--overwrite", "--set", "observer.age=50"];
    let whole = std::fs::read(other.name(5)).unwrap();
    std::fs::write(other.name(5), &whole[..200]).unwrap();
    assert_eq!(other.run(&set).status.code(), Some(1));
    let theirs = std::fs::read(other.at("o/checkpoint.sungaze")).unwrap();
    assert_eq!(resumed(&theirs), Some(2));
}

#[test]
fn a_folder_that_holds_inputs_or_strangers_files_is_never_emptied() {
    for flag in ["--overwrite", "--resume"] {
        let stage = Stage::new(3);
        // Frames under the names that a run gives to its own.
        std::fs::create_dir(stage.at("o")).unwrap();
        for number in 1..=3 {
            let name = format!("o/seen.{number:04}.exr");
            std::fs::rename(stage.name(number), stage.at(&name)).unwrap();
        }
        let before = stage.files();
        let frames = ["--set", "input.frames=o/seen.####.exr", flag];
        for more in [&frames[..], &frames[..2], &[flag]] {
            assert_eq!(stage.run(more).status.code(), Some(2), "{more:?}");
        }
        assert!(before == stage.files(), "{flag}");
    }
}

#[test]
fn the_results_of_a_run_are_no_input_of_another_into_the_same_folder() {
    let stage = Stage::new(3);
    assert_eq!(stage.run(&[]).status.code(), Some(0));
    let before = stage.files();
    for flag in ["--overwrite", "--resume"] {
        let output = stage.run(&["--set", "input.frames=o/seen.####.exr", flag]);
        assert_eq!(output.status.code(), Some(2));
        assert!(told(&output).contains("seen.0001.exr"), "{}", told(&output));
    }
    assert!(before == stage.files());
}

#[cfg(unix)]
#[test]
fn links_are_not_followed_out_of_the_folder() {
    for name in [".sungaze", ".sungaze-lock.tmp", "trace.csv", "checkpoint.sungaze"] {
        let stage = Stage::new(3);
        std::fs::create_dir(stage.at("o")).unwrap();
        std::fs::write(stage.at("victim"), "precious").unwrap();
        std::os::unix::fs::symlink("../victim", stage.at("o").join(name)).unwrap();
        for flag in [&[][..], &["--overwrite"], &["--resume"]] {
            stage.run(flag);
            assert_eq!(std::fs::read_to_string(stage.at("victim")).unwrap(), "precious", "{name}");
        }
    }
    // A table that becomes a link is not written through.
    let stage = Stage::stopped();
    std::fs::rename(stage.at("o/trace.csv"), stage.at("victim")).unwrap();
    std::os::unix::fs::symlink("../victim", stage.at("o/trace.csv")).unwrap();
    let before = std::fs::read(stage.at("victim")).unwrap();
    assert_eq!(stage.run(&["--resume"]).status.code(), Some(1));
    assert_eq!(stage.run(&["--overwrite"]).status.code(), Some(0));
    assert_eq!(std::fs::read(stage.at("victim")).unwrap(), before);
    let stage = Stage::new(3);
    // A link to the folder of the frames is that folder.
    std::fs::create_dir(stage.at("frames")).unwrap();
    (1..=3).for_each(|n| {
        std::fs::rename(stage.name(n), stage.at(&format!("frames/seen.{n:04}.exr"))).unwrap()
    });
    std::os::unix::fs::symlink("frames", stage.at("link")).unwrap();
    let set = ["run", "c.toml", "--set", "input.frames=frames/seen.####.exr", "--out", "link"];
    let output = sungaze(stage.0.path(), &[&set[..], &["--overwrite"]].concat());
    assert_eq!(output.status.code(), Some(2), "{}", told(&output));
    assert!((1..=3).all(|n| stage.at(&format!("frames/seen.{n:04}.exr")).exists()));
}

/// A run whose ffmpeg is a script.
#[cfg(unix)]
fn filmed(stage: &Stage, script: &str, more: &[&str]) -> Command {
    use std::os::unix::fs::PermissionsExt;
    let ffmpeg = stage.at("bin/ffmpeg");
    std::fs::create_dir_all(stage.at("bin")).unwrap();
    std::fs::write(&ffmpeg, format!("#!/bin/sh\nfor a; do film=$a; done\n{script}\n")).unwrap();
    std::fs::set_permissions(&ffmpeg, std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", stage.at("bin").display(), std::env::var("PATH").unwrap());
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    let set = ["run", "c.toml", "--out", "o", "--set", "output.video=film.mp4"];
    command.current_dir(stage.0.path()).env("PATH", path).args(set).args(more);
    command
}

#[cfg(unix)]
#[test]
fn a_film_is_whole_or_not_there_and_made_again_by_resume() {
    let stage = Stage::new(3);
    let film = stage.at("o/film.mp4");
    let failed = filmed(&stage, "echo half > $film; echo 'no codec' >&2; exit 1", &[]).output();
    let failed = failed.unwrap();
    assert_eq!(failed.status.code(), Some(1));
    assert!(told(&failed).contains("film.mp4") && told(&failed).contains("no codec"));
    assert!(!film.exists());
    let made = filmed(&stage, "echo whole > $film", &["--resume"]).output().unwrap();
    assert_eq!(made.status.code(), Some(0), "{}", told(&made));
    assert_eq!(std::fs::read_to_string(&film).unwrap(), "whole\n");
    let left = std::fs::read_dir(stage.at("o")).unwrap().map(|e| e.unwrap().file_name());
    assert!(left.filter(|name| name.to_string_lossy().contains(".tmp")).count() == 0);
}

#[cfg(unix)]
#[test]
fn a_run_is_interrupted_while_ffmpeg_works_and_leaves_no_half_film() {
    let stage = Stage::new(3);
    let script =
        format!("echo half > $film; : > {}; exec sleep 600", stage.at("started").display());
    let mut child = filmed(&stage, &script, &["--quiet"]).spawn().unwrap();
    while !stage.at("started").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!stage.at("o/film.mp4").exists());
    let made = filmed(&stage, "echo whole > $film", &["--resume"]).output().unwrap();
    assert_eq!(made.status.code(), Some(0), "{}", told(&made));
    assert!(stage.at("o/film.mp4").exists());
}

/// A checkpoint of another hand, whose digest is right: `change` is done to its content.
fn forged(bytes: &[u8], change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    use sha2::{Digest, Sha256};
    let mut content = bytes[..bytes.len() - 32].to_vec();
    change(&mut content);
    let digest = Sha256::digest(&content);
    content.extend_from_slice(&digest);
    content
}

#[test]
fn a_forged_checkpoint_whose_digest_is_right_breaks_nothing() {
    let stage = Stage::stopped();
    let kept: Vec<(PathBuf, Vec<u8>)> = std::fs::read_dir(stage.at("o"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.clone(), std::fs::read(path).unwrap()))
        .collect();
    let checkpoint = stage.at("o/checkpoint.sungaze");
    let bytes = std::fs::read(&checkpoint).unwrap();
    let first = b"sungaze checkpoint\n".len();
    let last = bytes.len() - 32;
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    let mut draw = |below: usize| {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random % below as u64) as usize
    };
    for case in 0..160 {
        // The head, where lengths and counts stand, is hit as often as the many fractions.
        let within = if case % 2 == 0 { (last - first).min(1200) } else { last - first };
        let (at, what, value) = (first + draw(within), draw(4), draw(256) as u8);
        let forgery = forged(&bytes, |content| match what {
            0 => content[at] = value,
            1 => content[at..(at + 8).min(last)].fill(0xff),
            2 => drop(content.remove(at)),
            _ => content.insert(at, value),
        });
        std::fs::remove_dir_all(stage.at("o")).unwrap();
        std::fs::create_dir(stage.at("o")).unwrap();
        kept.iter().for_each(|(path, bytes)| std::fs::write(path, bytes).unwrap());
        std::fs::write(&checkpoint, forgery).unwrap();
        let output = stage.run(&["--resume"]);
        let code = output.status.code();
        let told = told(&output);
        assert!(matches!(code, Some(0..=3)), "case {case}, byte {at}: {code:?} {told}");
    }
}
