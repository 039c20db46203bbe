//! Runs that are killed, interrupted or refused: nothing half-written, nothing lost.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

const RUN: [&str; 12] = [
    "run",
    "--quiet",
    "--set",
    "input.width=96",
    "--set",
    "output.checkpoint_s=0",
    "--set",
    "output.state=every",
    "--set",
    "observer.pupil_delay_s=0.2",
    "--set",
    "observer.pupil_closing_s=0.3",
];

fn start(folder: &Path, more: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    command.args(RUN).args(more).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("the program starts")
}

fn finish(folder: &Path, more: &[&str]) -> i32 {
    start(folder, more).wait().unwrap().code().unwrap_or(-1)
}

/// Every file of a run but the report and what is still being written.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let named =
        entries.map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), path));
    named
        .filter(|(name, _)| !name.ends_with(".tmp") && name != "report.json")
        .map(|(name, path)| (name, std::fs::read(path).unwrap()))
        .collect()
}

#[test]
fn a_run_killed_at_any_moment_resumes_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(finish(folder.path(), &["--out", "whole"]), 0);
    let whole = files(&folder.path().join("whole"));
    assert_eq!(whole.len(), 60 * 3 + 7);
    let mut killed = 0;
    for moment in 0..10u32 {
        let out = format!("killed{moment}");
        let mut child = start(folder.path(), &["--out", &out]);
        // An odd stride over the run's frames, and a little later each, so that kills fall everywhere.
        let reached = folder.path().join(&out).join(format!("seen.{:04}.exr", moment * 17 % 50));
        while !reached.exists() && child.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        std::thread::sleep(Duration::from_micros(u64::from(moment) * 100));
        killed += u32::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        let at = folder.path().join(&out);
        if at.exists() {
            for (name, bytes) in files(&at) {
                let grows = name.ends_with(".csv") || name.ends_with(".sungaze");
                assert!(
                    grows || whole.get(&name) == Some(&bytes),
                    "{name} was half-written at kill {moment}"
                );
            }
        }
        assert_eq!(finish(folder.path(), &["--out", &out, "--resume"]), 0);
        let resumed = files(&at);
        assert_eq!(resumed.keys().collect::<Vec<_>>(), whole.keys().collect::<Vec<_>>());
        for (name, bytes) in &whole {
            assert_eq!(&resumed[name], bytes, "{name} after kill {moment}");
        }
        let left = std::fs::read_dir(&at)
            .unwrap()
            .filter(|e| e.as_ref().unwrap().path().extension().is_some_and(|x| x == "tmp"));
        assert_eq!(left.count(), 0, "temporary files are swept up");
    }
    assert!(killed > 2, "only {killed} of 10 runs were still going when killed");
}

/// Sends a signal to a run once a file is there.
#[cfg(unix)]
fn signalled(mut child: Child, signal: &str, once: &Path) -> Option<i32> {
    while !once.exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(
        Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success()
    );
    child.wait().unwrap().code()
}

#[cfg(unix)]
#[test]
fn a_run_that_is_interrupted_or_terminated_finishes_its_frame_and_can_go_on() {
    for signal in ["-INT", "-TERM"] {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path().join("o");
        let child = start(
            folder.path(),
            &["--out", "o", "--set", "time.duration_s=3600", "--set", "time.fps=1"],
        );
        assert_eq!(signalled(child, signal, &at.join("seen.0002.exr")), Some(130));
        assert!(at.join("checkpoint.sungaze").exists());
        let rows = std::fs::read_to_string(at.join("trace.csv")).unwrap().lines().count() - 1;
        let written = files(&at).keys().filter(|name| name.starts_with("seen.0")).count();
        assert_eq!(rows, written, "a row of the trace for every frame");
        let changed = finish(
            folder.path(),
            &["--out", "o", "--resume", "--set", "time.duration_s=3600", "--set", "time.fps=2"],
        );
        assert_eq!(changed, 2, "changed settings are refused");
    }
}

#[cfg(unix)]
#[test]
fn a_frame_of_hours_is_left_when_the_user_asks_to_stop() {
    let folder = tempfile::tempdir().unwrap();
    let keys = [
        "observer.kinetics=rate-limited",
        "numerics.model=tracked",
        "numerics.budget=1e-12",
        "input.width=4000",
    ];
    let slow = keys.iter().flat_map(|key| ["--set", key]);
    let child = start(folder.path(), &["--out", "o"].into_iter().chain(slow).collect::<Vec<_>>());
    assert_eq!(signalled(child, "-INT", &folder.path().join("o/trace.csv")), Some(130));
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_is_reported_as_such() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "not a folder").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_sungaze"))
        .args(RUN)
        .args(["--out", "file/inside"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(told.contains("file/inside") && told.contains("cannot create"), "{told}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_table_that_cannot_grow_is_reported_and_leaves_no_half_picture() {
    // Files may not grow beyond 64 blocks: a picture or a table of such a run stops it.
    let folder = tempfile::tempdir().unwrap();
    let limited = format!(
        "trap '' XFSZ; ulimit -f 64; exec {} {} --out o --set input.width=400",
        env!("CARGO_BIN_EXE_sungaze"),
        RUN.join(" ")
    );
    let output =
        Command::new("sh").args(["-c", &limited]).current_dir(folder.path()).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("seen.start.exr") && told.contains("cannot write"), "{told}");
    assert!(!folder.path().join("o/seen.start.exr").exists());
    assert_eq!(finish(folder.path(), &["--out", "o", "--set", "input.width=400", "--resume"]), 0);
}

/// How often the threads of a process have waited for something.
#[cfg(target_os = "linux")]
fn waits(id: u32) -> u64 {
    let of = |task: std::fs::DirEntry| {
        let status = std::fs::read_to_string(task.path().join("status")).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("voluntary_ctxt_switches:"));
        line.map_or(0, |count| count.trim().parse::<u64>().unwrap())
    };
    std::fs::read_dir(format!("/proc/{id}/task")).unwrap().map(|task| of(task.unwrap())).sum()
}

#[cfg(target_os = "linux")]
#[test]
fn a_live_view_that_nobody_looks_at_sleeps_and_a_signal_ends_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_sungaze"));
    command.args(["view", "--no-open", "--set", "input.width=64"]).current_dir(folder.path());
    let mut view = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut address = String::new();
    BufReader::new(view.stdout.take().unwrap()).read_line(&mut address).unwrap();
    assert!(address.starts_with("http://127.0.0.1:"), "{address}");
    // Threads that have just worked fall asleep one after the other.
    let sleeps = (0..50).any(|_| {
        let before = waits(view.id());
        std::thread::sleep(Duration::from_millis(200));
        waits(view.id()) == before
    });
    let told = Command::new("kill").args(["-TERM", &view.id().to_string()]).status().unwrap();
    assert!(told.success());
    assert_eq!(view.wait().unwrap().code(), Some(130));
    assert!(sleeps, "a thread woke in each of 50 spans of 200 ms");
}
