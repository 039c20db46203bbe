//! A run: a sequence of frames through the eye, into a folder.
//!
//! Three stages with bounded queues between them: a reader decodes ahead, the eye looks, a writer encodes behind.
//! All share rayon's global pool (within a pool of the caller's own, only the eye moves there). Pixels and numbers do
//! not depend on how many threads there are.

pub(crate) mod checkpoint;
mod eye;
mod folder;
pub(crate) mod gaze;
pub(crate) mod inputs;
pub(crate) mod manifest;
pub(crate) mod plot;
mod reader;
pub(crate) mod record;
mod rehearse;
pub(crate) mod report;
mod resume;
mod scene;
pub(crate) mod schedule;
mod start;
mod video;
pub(crate) mod watch;
pub(crate) mod writer;

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::{Scope, ScopedJoinHandle};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::config::settings::SeenKey;
use crate::config::{Config, Settings};
use crate::error::{Error, Result};
use crate::eye::check::Check;
use crate::frames::{self, Overscan};
use crate::light::Planes;
use crate::page;
use crate::plot::moment::Cones;

use checkpoint::Checkpoint;
pub(crate) use eye::Watching;
pub(crate) use folder::{Claim, owned, same};
pub use folder::{Existing, not_empty};
pub use gaze::GazePath;
pub(crate) use gaze::Moment;
pub(crate) use inputs::tables;
pub(crate) use reader::Loaded;
pub use rehearse::rehearse;
use report::Timing;
use resume::Start;
pub use scene::{Scene, eye_for};
pub use watch::{Unwatched, Watch};
use writer::{Delivery, Tables, Writer};

/// How many frames may wait between two stages.
const QUEUE: usize = 2;

/// What a finished run leaves.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// `report.json`.
    pub report: Value,
    /// Whether some frames were bad and a policy let the run go on (exit code 3).
    pub went_on: bool,
    /// The run was complete already.
    pub already: bool,
}

/// Runs a configuration into a folder.
pub fn run(
    config: &Config,
    folder: &Path,
    existing: Existing,
    watch: &dyn Watch,
) -> Result<Outcome> {
    let resolved = resolved(&config.settings);
    // Everything that can be wrong is found before an earlier run's files are touched.
    config.compression()?;
    let scene = Scene::open(config)?;
    let mut eye = Watching::new(config, &scene, resolved)?;
    let _claim = Claim::new(folder, false)?;
    let lengths = match resume::start(config, &scene, &mut eye, folder, existing, watch)? {
        Start::Complete(report) => {
            if !folder.join(&config.settings.output.video).is_file() {
                film(config, &scene, folder, watch)?;
            }
            return Ok(Outcome { went_on: false, already: true, report });
        }
        Start::From(lengths) => Some(lengths),
        Start::Fresh => {
            eye.inputs = inputs::of_tables(config)?;
            None
        }
    };
    for note in &scene.footage.header().notes {
        watch.warn(note);
    }
    let written = stages(config, &scene, &mut eye, folder, lengths, watch)?;
    finish(config, &scene, eye, folder, written, watch)
}

/// The settings as JSON: what `report.json` shows and a resumed run is compared with.
pub(crate) fn resolved(settings: &Settings) -> Value {
    serde_json::to_value(settings).unwrap_or(Value::Null)
}

/// Runs the three stages side by side.
fn stages(
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

/// The writer of a configuration's pictures.
pub(crate) fn writer<'a>(
    config: &Config,
    scene: &'a Scene,
    resolved: &Value,
    folder: &'a Path,
) -> Result<Writer<'a>> {
    let digest = digest(resolved.to_string().as_bytes());
    Ok(Writer {
        folder,
        display: config.display(),
        seen_to_srgb: scene.vision.seen_to_srgb.map(|row| row.map(|v| v as f32)),
        seen: config.settings.output.seen == SeenKey::Exr,
        window: scene.footage.window(),
        halved: scene.footage.header().transfer.is_some(),
        plates: (config.settings.output.keep != Overscan::None).then_some(&*scene.footage),
        compression: config.compression()?,
        about: scene.about(&digest),
        digest,
    })
}

/// FNV-1a: a digest that names a configuration (not a secret).
pub(crate) fn digest(bytes: &[u8]) -> String {
    let fnv1a = |hash: u64, &b: &u8| (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3);
    format!("{:016x}", bytes.iter().fold(0xcbf2_9ce4_8422_2325, fnv1a))
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

/// Writes the report and the plot, and removes the checkpoint.
fn finish(
    config: &Config,
    scene: &Scene,
    eye: Watching,
    folder: &Path,
    written: Timing,
    watch: &dyn Watch,
) -> Result<Outcome> {
    let history = record::read_back(&folder.join("probes.csv"))?;
    let lms_to_xyz = scene.vision.observer.lms_to_xyz;
    let cones = Cones { kinetics: config.pigments(), lms_to_xyz };
    plot::write(&folder.join("probes.svg"), &history, &cones)?;
    let failed = eye.beyond(config.settings.numerics.budget);
    let told: Vec<String> = eye.counters.warnings().into_iter().chain(failed.clone()).collect();
    told.iter().for_each(|warning| watch.warn(warning));
    let mut timing = eye.spent();
    timing.add(&written);
    let report = report_of(config, scene, &eye, folder, (told, &timing))?;
    frames::atomic::write_lasting(&folder.join("report.json"), |to| writeln!(to, "{report:#}"))?;
    if config.settings.output.page {
        page::Report { title: &config.name, cases: vec![page::of_run(folder)?], report: &report }
            .write(folder)?;
    }
    Checkpoint::remove(folder)?;
    film(config, scene, folder, watch)?;
    Ok(Outcome { report, went_on: eye.counters.went_on() || failed.is_some(), already: false })
}

/// `report.json`.
fn report_of(
    config: &Config,
    scene: &Scene,
    eye: &Watching,
    folder: &Path,
    (told, timing): (Vec<String>, &Timing),
) -> Result<Value> {
    let header = scene.footage.header();
    let warnings: Vec<String> = header.notes.iter().cloned().chain(told).collect();
    Ok(json!({
        "config": eye.config,
        "version": env!("CARGO_PKG_VERSION"),
        "constants": report::constants(config),
        "columns": record::columns(),
        "plan": eye.eye.plan_report(),
        "check": eye.eye.check().map_or_else(report::unchecked, Check::report),
        "frames": {
            "count": scene.steps.len(),
            "width": header.width,
            "height": header.height,
            "last_s": scene.steps.last().map(|step| step.end),
            "nan_samples": eye.counters.nan,
            "infinite_samples": eye.counters.infinite,
            "negative_samples": eye.counters.negative,
            "clipped_samples": eye.counters.clipped,
            "mended": eye.counters.mended_frames,
            "held": eye.counters.held_frames,
        },
        "inputs": eye.inputs,
        "results": record::results(&folder.join("probes.csv"), eye.eye.pigments())?,
        "warnings": warnings,
        "timing": timing.report(),
    }))
}

/// Makes the film that `output.video` asks for, or says how to.
fn film(config: &Config, scene: &Scene, folder: &Path, watch: &dyn Watch) -> Result<()> {
    let output = &config.settings.output;
    if output.video == "none" {
        return Ok(());
    }
    if let Some(command) = video::make(folder, &output.video, &scene.pictured(), watch)? {
        watch.warn(&format!(
            "ffmpeg is not on the PATH; this makes the film where it is: {command}"
        ));
    }
    Ok(())
}
