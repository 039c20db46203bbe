//! Being asked to stop: SIGINT (Ctrl-C) and SIGTERM (`kill`, `timeout`, Slurm, docker) alike.
//!
//! The work goes on in a thread of its own. A run that is asked to stop finishes the frame in hand and leaves a
//! checkpoint. Work that has not begun to leave within [`PATIENCE`] (a frame of minutes, a chart) is left where it
//! stands: files appear whole or not at all, and a run writes a checkpoint before such frames. A second signal ends
//! the program at once.

use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use sungaze::error::Error;

use super::say;

/// How long work may go on after a signal without having begun to leave.
const PATIENCE: Duration = Duration::from_millis(800);
/// How long it may take to leave: to write a checkpoint to a slow disk.
const FAREWELL: Duration = Duration::from_secs(30);
/// How often the signals are asked for.
const OFTEN: Duration = Duration::from_millis(20);

static ASKED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Default::default);
static LEAVING: AtomicBool = AtomicBool::new(false);

/// Whether a signal has come.
pub fn asked() -> bool {
    ASKED.load(Ordering::SeqCst)
}

/// The work is leaving by itself and needs a moment.
pub fn leaving() {
    LEAVING.store(true, Ordering::SeqCst);
}

/// Takes the signals over. A system that refuses this keeps its own way of ending programs.
fn listen() {
    for signal in [SIGINT, SIGTERM] {
        let _ = signal_hook::flag::register_conditional_shutdown(signal, 130, ASKED.clone());
        let _ = signal_hook::flag::register(signal, ASKED.clone());
    }
}

/// Does some work until it is done or the user has asked to stop. `resumable`: it can be gone on with.
pub fn unless_asked(resumable: bool, work: impl FnOnce() -> ExitCode + Send + 'static) -> ExitCode {
    listen();
    let (done, wait) = sync_channel(1);
    let worker = std::thread::Builder::new().stack_size(8 << 20).spawn(move || done.send(work()));
    let worker = match worker {
        Ok(worker) => worker,
        Err(error) => {
            say::message(&format!("sungaze: cannot start a thread: {error}"));
            return ExitCode::FAILURE;
        }
    };
    let mut since: Option<Instant> = None;
    loop {
        match wait.recv_timeout(OFTEN) {
            Ok(code) => return code,
            Err(RecvTimeoutError::Timeout) => {}
            // The work has panicked: so does the program, with its exit code.
            Err(RecvTimeoutError::Disconnected) => match worker.join() {
                Err(panic) => std::panic::resume_unwind(panic),
                Ok(_) => return ExitCode::FAILURE,
            },
        }
        let waited = asked().then(|| since.get_or_insert_with(Instant::now).elapsed());
        let patience = if LEAVING.load(Ordering::SeqCst) { FAREWELL } else { PATIENCE };
        if waited.is_some_and(|waited| waited >= patience) {
            let stopped = Error::Interrupted { resumable };
            say::failure(&stopped);
            return ExitCode::from(stopped.exit_code());
        }
    }
}
