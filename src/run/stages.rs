//! The three stages side by side.

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{Scope, ScopedJoinHandle};
use std::time::{Duration, Instant};

use crate::config::Config;
use crate::error::{Error, Result};
use crate::light::Planes;

use super::eye::Watching;
use super::reader::{self, Loaded};
use super::report::{self, Timing};
use super::scene::Scene;
use super::watch::Watch;
use super::writer;
use super::writer::{Delivery, Tables};

/// How many frames may wait between two stages.
const QUEUE: usize = 2;

/// Runs the three stages side by side.
pub(super) fn run(
    config: &Config,
    scene: &Scene,
    eye: &mut Watching,
    folder: &Path,
    lengths: Option<[u64; 2]>,
    watch: &dyn Watch,
) -> Result<Timing> {
    let writer = writer(config, scene, &eye.config, folder)?;
    let tables = Tables::open(folder, &report::law_line(config), lengths)?;
    let steps = &scene.steps[eye.done..];
    let progress = (eye.done, scene.steps.len());
    let (to_eye, from_reader) = sync_channel(QUEUE);
    let (to_writer, from_eye) = sync_channel(QUEUE);
    let (give_back, spent_planes) = sync_channel(QUEUE + 2);
    let (give_back_seen, spent_seen) = sync_channel(QUEUE + 2);
    std::thread::scope(|threads| {
        let sequence = scene.sequence(eye.places_to_check());
        let reader =
            started(threads, move || reader::read_all(sequence, steps, &to_eye, &spent_planes))?;
        let writer = started(threads, move || {
            writer.write_all(tables, &from_eye, &give_back_seen, watch, progress)
        })?;
        let links = Links {
            from_reader: &from_reader,
            to_writer,
            give_back: &give_back,
            spent_seen: &spent_seen,
        };
        let looked = look_at_all(config, scene, eye, links, watch);
        drop((from_reader, give_back));
        join(reader);
        let written = join(writer)?;
        looked?;
        Ok(written)
    })
}

/// Starts a stage in a thread of its own.
fn started<'scope, T: Send + 'scope>(
    threads: &'scope Scope<'scope, '_>,
    stage: impl FnOnce() -> T + Send + 'scope,
) -> Result<ScopedJoinHandle<'scope, T>> {
    std::thread::Builder::new().spawn_scoped(threads, stage).map_err(Error::io("a thread", "start"))
}

/// A stage's result; a stage that panicked (our bug) panics here.
fn join<T>(thread: ScopedJoinHandle<'_, T>) -> T {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

/// What ties the eye's stage to its neighbours: frames one way, planes to be written over the other.
struct Links<'a> {
    from_reader: &'a Receiver<Result<Arc<Loaded>>>,
    to_writer: SyncSender<Delivery>,
    give_back: &'a SyncSender<Planes>,
    spent_seen: &'a Receiver<Planes>,
}

impl Links<'_> {
    /// `None` if the writer has hung up.
    fn send(&self, delivery: Delivery) -> Option<()> {
        self.to_writer.send(delivery).ok()
    }
}

/// A frame that takes longer than this has a checkpoint before it: whoever stops the run within it loses little.
const LONG: Duration = Duration::from_secs(1);

/// How often a run that waits for a frame asks whether it should stop.
const OFTEN: Duration = Duration::from_millis(50);

/// The eye's stage: every frame in order, checkpoints now and then.
fn look_at_all(
    config: &Config,
    scene: &Scene,
    eye: &mut Watching,
    links: Links<'_>,
    watch: &dyn Watch,
) -> Result<()> {
    let every = Duration::from_secs_f64(config.settings.output.checkpoint_s);
    let mut last_checkpoint = Instant::now();
    while eye.done < scene.steps.len() {
        if watch.interrupted() {
            return stopped(scene, eye, &links, watch);
        }
        let step = &scene.steps[eye.done];
        let loaded = match links.from_reader.recv_timeout(OFTEN) {
            Ok(loaded) => loaded?,
            Err(RecvTimeoutError::Timeout) => continue,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        };
        eye.note(&scene.steps, &loaded);
        if eye.done == 0 {
            let start = eye.at_the_start(&loaded, step)?;
            let Some(()) = links.send(Delivery::Start(Box::new(start))) else { return Ok(()) };
        }
        let begun = Instant::now();
        let Some(()) = look_at_one(scene, eye, &links, loaded) else { return Ok(()) };
        let due = last_checkpoint.elapsed() >= every || begun.elapsed() >= LONG;
        if due && eye.done < scene.steps.len() {
            last_checkpoint = Instant::now();
            let checkpoint = Box::new(eye.checkpoint(&scene.steps));
            let Some(()) = links.send(Delivery::Checkpoint(checkpoint)) else { return Ok(()) };
        }
    }
    Ok(())
}

/// One frame from the reader to the writer; `None` if the writer has hung up.
fn look_at_one(
    scene: &Scene,
    eye: &mut Watching,
    links: &Links<'_>,
    loaded: Arc<Loaded>,
) -> Option<()> {
    let last = eye.done + 1 == scene.steps.len();
    let finished = eye.see(&loaded, &scene.steps[eye.done], last, links.spent_seen.try_recv().ok());
    if let Some(spent) = Arc::into_inner(loaded) {
        // A full queue only means that the planes are dropped here.
        let _ = links.give_back.try_send(spent.frame.planes);
    }
    links.send(Delivery::Frame(Box::new(finished)))
}

/// Leaves a checkpoint of what is done.
fn stopped(scene: &Scene, eye: &Watching, links: &Links<'_>, watch: &dyn Watch) -> Result<()> {
    watch.leaving();
    if eye.done > 0 {
        // A writer that has hung up says why itself.
        let _ = links.send(Delivery::Checkpoint(Box::new(eye.checkpoint(&scene.steps))));
    }
    Err(Error::Interrupted { resumable: true })
}
