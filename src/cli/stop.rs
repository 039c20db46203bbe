//! Being asked to stop: SIGINT (Ctrl-C) and SIGTERM (`kill`, `timeout`, Slurm, docker) alike.
//!
//! The work goes on in a thread of its own. A run that is asked to stop finishes the frame in hand and leaves a
//! checkpoint. Work that has not begun to leave within [`PATIENCE`] (a frame of minutes, a chart) is left where it
//! stands: files appear whole or not at all, and a run writes a checkpoint before such frames. A second signal ends
//! the program at once.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, LazyLock};
use std::thread::Builder;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use sungaze::error::Error;

use super::say;

/// How long work may go on after a signal without having begun to leave.
const PATIENCE: Duration = Duration::from_millis(800);
/// How long it may take to leave: to write a checkpoint to a slow disk.
const FAREWELL: Duration = Duration::from_secs(30);
/// How often work that is to leave is asked whether it has begun to.
const OFTEN: Duration = Duration::from_millis(20);

static ASKED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Default::default);
static LEAVING: AtomicBool = AtomicBool::new(false);

/// Whether a signal has come.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}

/// The work is leaving by itself and needs a moment.
pub(crate) fn leaving() {
    LEAVING.store(true, Ordering::SeqCst);
}

/// Takes the signals over. A system that refuses this keeps its own way of ending programs.
fn listen() {
    for signal in [SIGINT, SIGTERM] {
        let _ = signal_hook::flag::register_conditional_shutdown(signal, 130, ASKED.clone());
        let _ = signal_hook::flag::register(signal, ASKED.clone());
    }
}

/// Waits for a signal that [`listen`] has taken over. Windows has none that a thread could wait for.
fn wait_for_signal() {
    #[cfg(unix)]
    if let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) {
        signals.forever().next();
    }
    while !asked() {
        std::thread::sleep(OFTEN);
    }
}

/// Holds the thread that works until a signal has come.
pub(crate) fn wait() {
    while !asked() {
        std::thread::park();
    }
}

/// How work has ended: with its exit code, or its panic.
type End = std::thread::Result<ExitCode>;

/// Does some work until it is done or the user has asked to stop. `resumable`: it can be gone on with.
pub(crate) fn unless_asked(
    resumable: bool,
    work: impl FnOnce() -> ExitCode + Send + 'static,
) -> ExitCode {
    listen();
    let (news, heard) = channel();
    let done = news.clone();
    let work = move || done.send(Some(catch_unwind(AssertUnwindSafe(work))));
    let worker = match Builder::new().stack_size(8 << 20).spawn(work) {
        Ok(worker) => worker.thread().clone(),
        Err(error) => {
            say::message(&format!("sungaze: cannot start a thread: {error}"));
            return ExitCode::FAILURE;
        }
    };
    let signals = move || {
        wait_for_signal();
        worker.unpark();
        news.send(None)
    };
    // Without this thread the work is asked to stop all the same, but not left.
    let _ = Builder::new().name("signals".into()).spawn(signals);
    let end = heard.recv().ok().flatten().or_else(|| end_in_time(&heard));
    end.map_or_else(|| stopped(resumable), |end| end.unwrap_or_else(|panic| resume_unwind(panic)))
}

/// The end of work that has been asked to stop; `None`: it takes too long.
fn end_in_time(news: &Receiver<Option<End>>) -> Option<End> {
    let since = Instant::now();
    loop {
        if let Ok(end) = news.recv_timeout(OFTEN) {
            return end;
        }
        let patience = if LEAVING.load(Ordering::SeqCst) { FAREWELL } else { PATIENCE };
        if since.elapsed() >= patience {
            return None;
        }
    }
}

fn stopped(resumable: bool) -> ExitCode {
    let stopped = Error::Interrupted { resumable };
    say::failure(&stopped);
    ExitCode::from(stopped.exit_code())
}
