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
mod stages;
mod start;
mod video;
pub(crate) mod watch;
pub(crate) mod writer;

use std::path::Path;

use serde_json::{Value, json};

use crate::config::settings::SeenKey;
use crate::config::{Config, Settings};
use crate::error::Result;
use crate::eye::check::Check;
use crate::frames::{self, Overscan};
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
use writer::Writer;

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
    let written = stages::run(config, &scene, &mut eye, folder, lengths, watch)?;
    finish(config, &scene, eye, folder, written, watch)
}

/// The settings as JSON: what `report.json` shows and a resumed run is compared with.
pub(crate) fn resolved(settings: &Settings) -> Value {
    serde_json::to_value(settings).unwrap_or(Value::Null)
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
            "nan_samples": eye.counters.tally.nan,
            "infinite_samples": eye.counters.tally.infinite,
            "negative_samples": eye.counters.tally.negative,
            "clipped_samples": eye.counters.tally.clipped,
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
