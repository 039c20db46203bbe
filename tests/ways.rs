//! Any way of using a folder: kills, deletions, renames, resumes with any number of threads and
//! overwrites, in any order. A run is right or refuses, and what is not its own stays.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

use proptest::prelude::*;

const FRAMES: u32 = 12;

/// One thing that somebody does to a folder.
#[derive(Clone, Debug)]
enum Act {
    /// Starts or resumes, and is ended by a signal once a frame is there.
    Ended { by: Signal, frame: u32 },
    /// Resumes to the end.
    Resumed { threads: &'static str },
    /// Begins anew.
    Overwritten,
    /// Loses a file of the run's own.
    Loses { which: usize },
    /// Puts a file of somebody else's into the folder.
    Foreign { name: &'static str },
    /// Moves the input frame of this number away, or back.
    Moves { frame: u32 },
}

/// What ends a run.
#[derive(Clone, Copy, Debug)]
enum Signal {
    Kill,
    Terminate,
}

/// The input of frame `i`: a grey that brightens, written anew for every folder with the same bytes.
fn input(folder: &Path, frame: u32) -> std::path::PathBuf {
    folder.join(format!("in/a.{frame:04}.exr"))
}

fn inputs(folder: &Path) {
    use exr::prelude::{WritableImage, f16};
    std::fs::create_dir(folder.join("in")).unwrap();
    for frame in 1..=FRAMES {
        let grey = move |x: usize, y: usize| f16::from_f32(frame as f32 + (x * y) as f32);
        let image = exr::prelude::Image::from_channels(
            (24, 13),
            exr::prelude::SpecificChannels::rgb(move |at: exr::math::Vec2<usize>| {
                (grey(at.x(), at.y()), f16::ONE, grey(at.y(), 1))
            }),
        );
        image.write().to_file(input(folder, frame)).unwrap();
    }
}

fn ended(by: Signal) -> impl Strategy<Value = Act> {
    (1..=FRAMES).prop_map(move |frame| Act::Ended { by, frame })
}

fn acts() -> impl Strategy<Value = Vec<Act>> {
    let foreign =
        prop::sample::select(&["notes.txt", "seen.backup.exr", "seen.0099.exr", "render.exr"][..]);
    let act = prop_oneof![
        2 => ended(Signal::Kill),
        1 => ended(Signal::Terminate),
        2 => prop::sample::select(&["1", "2", "5"][..]).prop_map(|threads| Act::Resumed { threads }),
        1 => Just(Act::Overwritten),
        2 => (0..64usize).prop_map(|which| Act::Loses { which }),
        1 => foreign.prop_map(|name| Act::Foreign { name }),
        1 => (1..=FRAMES).prop_map(|frame| Act::Moves { frame }),
    ];
    prop::collection::vec(act, 1..6)
}

fn command(folder: &Path, flags: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    let keys = [
        "input.horizontal_fov_deg=20",
        "input.white_cd_m2=4e4",
        "output.checkpoint_s=0",
        "time.fps=24",
    ];
    command.args(["run", "in/a.####.exr", "--quiet", "--out", "o"]).args(flags);
    command.args(keys.iter().flat_map(|key| ["--set", key]));
    command.current_dir(folder).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Exit code and message of a whole command.
fn done(folder: &Path, flags: &[&str]) -> (i32, String) {
    let out = command(folder, flags).output().unwrap();
    (out.status.code().unwrap_or(-1), String::from_utf8_lossy(&out.stderr).into_owned())
}

/// The files of a folder but the report and its page, which tell how long it took.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let named = entries.map(|e| (e.file_name().to_string_lossy().into_owned(), e.path()));
    let kept = named.filter(|(name, _)| !["report.json", "report.html"].contains(&name.as_str()));
    kept.map(|(name, path)| (name, std::fs::read(path).unwrap())).collect()
}

fn ended_by(signal: Signal, folder: &Path, frame: u32) {
    let begun = folder.join("o").exists();
    let mut child = command(folder, if begun { &["--resume"] } else { &[] }).spawn().unwrap();
    let reached = folder.join(format!("o/seen.{frame:04}.exr"));
    while !reached.exists() && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    match signal {
        Signal::Kill => child.kill().unwrap(),
        Signal::Terminate => {
            // A run may have ended by itself meanwhile.
            let id = child.id().to_string();
            drop(Command::new("kill").args(["-TERM", &id]).stderr(Stdio::null()).status());
        }
    }
    child.wait().unwrap();
}

/// Moves an input away, or back.
fn moved(folder: &Path, frame: u32) {
    let (here, away) = (input(folder, frame), folder.join(format!("{frame}.away")));
    let moved = if here.exists() { (here, away) } else { (away, here) };
    std::fs::rename(moved.0, moved.1).unwrap();
}

/// Does one thing; returns the foreign file that it left.
fn act(folder: &Path, act: &Act) -> Option<&'static str> {
    let out = folder.join("o");
    match act {
        Act::Ended { by, frame } => ended_by(*by, folder, *frame),
        Act::Resumed { threads } => drop(done(folder, &["--resume", "--threads", threads])),
        Act::Moves { frame } => moved(folder, *frame),
        Act::Overwritten => drop(done(folder, &["--overwrite"])),
        Act::Loses { which } => {
            let names: Vec<String> = files(&out).into_keys().collect();
            let own = |name: &&String| !name.contains("backup") && !name.ends_with(".txt");
            let own: Vec<&String> = names.iter().filter(own).collect();
            if let Some(name) = own.get(which % own.len().max(1)) {
                std::fs::remove_file(out.join(name)).unwrap();
            }
        }
        Act::Foreign { name } if out.exists() => {
            std::fs::write(out.join(name), "not ours").unwrap();
            return Some(name);
        }
        Act::Foreign { .. } => {}
    }
    None
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_is_done_to_a_folder_a_run_is_right_or_refuses(acts in acts()) {
        let folder = tempfile::tempdir().unwrap();
        let whole = tempfile::tempdir().unwrap();
        inputs(folder.path());
        inputs(whole.path());
        prop_assert_eq!(done(whole.path(), &[]).0, 0);
        let read = files(&whole.path().join("in"));
        let whole = files(&whole.path().join("o"));
        let out = folder.path().join("o");
        let mut foreign = Vec::new();
        for each in &acts {
            foreign.extend(act(folder.path(), each));
            for name in &foreign {
                let kept = std::fs::read(out.join(name)).ok();
                let lost = matches!(each, Act::Loses { .. }) && kept.is_none();
                prop_assert!(lost || kept.as_deref() == Some(b"not ours"), "{} after {:?}", name, each);
            }
            foreign.retain(|name| out.join(name).exists());
        }
        let (code, message) = done(folder.path(), &["--resume"]);
        let away = (1..=FRAMES).filter(|frame| !input(folder.path(), *frame).exists());
        let away: Vec<u32> = away.collect();
        for frame in &away {
            moved(folder.path(), *frame);
        }
        prop_assert!(files(&folder.path().join("in")) == read, "an input was touched");
        prop_assert!(code == 0 || (code <= 2 && !message.is_empty()), "{} {}", code, message);
        prop_assert!(!message.contains("panicked"), "{}", message);
        if code == 0 && away.is_empty() {
            let left = files(&out);
            for (name, bytes) in &whole {
                prop_assert!(left.get(name) == Some(bytes), "{} is wrong or missing", name);
            }
        }
    }
}
