//! A run: a sequence of frames through the eye, into a folder.
//!
//! Three stages with bounded queues between them: a reader decodes ahead, the eye looks, a writer encodes behind.
//! All share one thread pool, the caller's. Pixels and numbers do not depend on its size.

pub mod checkpoint;
mod folder;
mod gaze;
mod plot;
mod reader;
pub mod record;
mod rehearse;
pub mod report;
mod scene;
pub mod schedule;
mod video;
pub mod watch;
pub(crate) mod writer;

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use ndarray::Array3;
use serde_json::{Value, json};

use crate::check::Check;
use crate::config::settings::{DisplayFile, SeenKey, StateKey};
use crate::config::{Config, Settings};
use crate::display::{Display, ToneMap};
use crate::error::{Error, Result};
use crate::frames;
use crate::light::{Planes, Samples};
use crate::plan::Plan;
use crate::retina::{Model, Retina};
use crate::units::{Nits, Seconds};
use crate::viewer::{Look, Viewer};

use checkpoint::Checkpoint;
use folder::Prepared;
pub(crate) use folder::same;
pub use folder::{Existing, not_empty};
pub use gaze::Gaze;
use reader::Loaded;
use record::{Probe, Reading};
pub use rehearse::rehearse;
use report::Counters;
pub use scene::Scene;
use schedule::Step;
pub use watch::{Unwatched, Watch};
use writer::{Delivery, Finished, Tables, Writer};

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
pub fn run(config: &Config, folder: &Path, existing: Existing, watch: &dyn Watch) -> Result<Outcome> {
    let begun = Instant::now();
    let resolved = resolved(&config.settings);
    // Everything that can be wrong is found before an earlier run's files are touched.
    config.compression()?;
    let scene = Scene::open(config)?;
    let mut eye = Eye::new(config, &scene, resolved.clone())?;
    let resume = match folder::prepare(folder, existing, &resolved)? {
        Prepared::Complete(report) => return Ok(Outcome { went_on: false, already: true, report }),
        Prepared::Resume(checkpoint) => Some(*checkpoint),
        Prepared::Fresh => None,
    };
    if let Some(checkpoint) = &resume {
        eye.restore(checkpoint)?;
    }
    for note in &scene.footage.header().notes {
        watch.warn(note);
    }
    let spent = stages(config, &scene, &mut eye, folder, resume.as_ref(), watch)?;
    finish(config, &scene, eye, folder, spent, begun, watch)
}

/// The settings as JSON: what `report.json` shows and a resumed run is compared with.
pub fn resolved(settings: &Settings) -> Value {
    serde_json::to_value(settings).unwrap_or(Value::Null)
}

/// The eye between the two other stages, with everything it carries from frame to frame.
struct Eye {
    viewer: Viewer,
    gaze: Gaze,
    probes: Vec<Probe>,
    display: Option<Display>,
    map: Option<Arc<ToneMap>>,
    counters: Counters,
    check: Option<Check>,
    state: StateKey,
    config: Value,
    done: usize,
    busy: Duration,
}

impl Eye {
    fn new(config: &Config, scene: &Scene, resolved: Value) -> Result<Eye> {
        let header = scene.footage.header();
        let retina = match config.settings.observer.start.as_str() {
            "rested" | "adapted" => Retina::rested(header.width, header.height),
            file => retina_of_file(config, file, header.width, header.height)?,
        };
        let pixels_per_degree = scene.pixels_per_degree;
        let mut viewer =
            Viewer::new(scene.vision.clone(), config.pigments(), config.model()?, retina, pixels_per_degree);
        viewer.plan = config.plan();
        viewer.surround = Nits(config.settings.gaze.surround_cd_m2);
        Ok(Eye {
            viewer,
            gaze: Gaze::of(config)?,
            probes: record::probes(config),
            display: (config.settings.output.display == DisplayFile::Png).then(|| scene.display(config)),
            map: None,
            counters: Counters { held_frames: scene.held.clone(), ..Counters::default() },
            check: None,
            state: config.settings.output.state,
            config: resolved,
            done: 0,
            busy: Duration::ZERO,
        })
    }

    fn restore(&mut self, checkpoint: &Checkpoint) -> Result<()> {
        let c = checkpoint.clone();
        let retina = Retina::restored(c.retina, c.retina_size, c.retina_origin, c.beyond.map(f64::from_bits));
        self.viewer.retina = retina.ok_or_else(|| Error::file(checkpoint::NAME, "holds a retina of another size"))?;
        self.viewer.first_gaze = c.first_gaze;
        self.viewer.pupil.restore(&c.pupil);
        self.viewer.plan.restore(&c.plan);
        self.map = self.display.as_ref().and_then(|display| display.restore(c.map)).map(Arc::new);
        (self.counters, self.done, self.check) = (c.counters, c.done, c.check);
        Ok(())
    }

    fn checkpoint(&self, steps: &[Step]) -> Checkpoint {
        let retina = &self.viewer.retina;
        let header = checkpoint::Header {
            config: self.config.clone(),
            done: self.done,
            last_frame: steps[self.done - 1].number,
            first_gaze: self.viewer.first_gaze,
            retina_size: retina.size(),
            retina_origin: retina.origin(),
            beyond: retina.beyond(),
            counters: self.counters.clone(),
            check: self.check.clone(),
        };
        let map = self.map.as_ref().map_or(Vec::new(), |map| map.levels().to_vec());
        let plan = self.viewer.plan.to_numbers();
        Checkpoint::new(header, retina.fractions().to_vec(), map, self.viewer.pupil.to_numbers(), plan)
    }

    /// The places of the sampled check: `None`: to be chosen on the first frame; none where a model was asked for
    /// that is not meant to be true.
    fn places_to_check(&self) -> Option<Vec<[usize; 2]>> {
        match (&self.check, self.viewer.model) {
            (Some(check), _) => Some(check.places.clone()),
            (None, Model::Tracked { .. }) => None,
            _ => Some(Vec::new()),
        }
    }

    /// The steady state of the first frame, before the first look.
    fn adapt(&mut self, loaded: &Loaded, gaze: [f64; 2], duration: Seconds) {
        let (pupil, model) = (self.viewer.pupil.clone(), self.viewer.model);
        let plan = std::mem::replace(&mut self.viewer.plan, Plan::new(None));
        self.viewer.model = Model::Steady;
        self.viewer.look(&loaded.frame.planes, &loaded.survey, gaze, duration, None);
        (self.viewer.pupil, self.viewer.model, self.viewer.plan) = (pupil, model, plan);
    }

    /// Looks at one frame and hands over what is to be written of it. `recycled`: a percept to be written over.
    fn see(&mut self, loaded: &Loaded, step: &Step, adapt: bool, last: bool, recycled: Option<Planes>) -> Finished {
        let begun = Instant::now();
        let planes = &loaded.frame.planes;
        let size = [planes.width, planes.height];
        let gaze = self.gaze.pixel(step.end(), &loaded.survey, size, self.viewer.first_gaze);
        let duration = Seconds(step.duration);
        if adapt {
            self.adapt(loaded, gaze, duration);
        }
        let mut check = self.check.take().unwrap_or_else(|| self.viewer.check(&loaded.places));
        let look = self.viewer.look(planes, &loaded.survey, gaze, duration, recycled);
        self.viewer.compare(&mut check, planes, loaded.kept.as_deref(), &look, gaze, duration);
        self.check = Some(check);
        self.meet(&look, step, size[0] * size[1]);
        let readings: Vec<Reading> =
            self.probes.iter().map(|probe| probe.read(&self.viewer, planes, &look, gaze)).collect();
        if let Some(display) = &self.display {
            let map = display.follow(self.map.as_deref(), &loaded.survey, duration);
            self.map = Some(Arc::new(map));
        }
        let finished = Finished {
            number: step.number,
            trace: record::trace_row(&self.viewer, planes, &look, gaze, step),
            probes: record::probe_rows(&readings, step),
            map: self.map.clone(),
            state: self.state_file(step, size, last),
            seen: look.seen,
        };
        self.done += 1;
        self.busy += begun.elapsed();
        finished
    }

    fn state_file(&self, step: &Step, size: [usize; 2], last: bool) -> Option<(Option<u32>, Planes, f64)> {
        let number = match self.state {
            StateKey::Every => Some(step.number),
            StateKey::Last if last => None,
            _ => return None,
        };
        let view = self.viewer.retina.first_view(size[0], size[1]);
        let samples = Samples::Float(view.iter().map(|&p| p as f32).collect());
        Some((number, Planes { width: size[0], height: size[1], count: 3, samples }, step.end()))
    }

    fn meet(&mut self, look: &Look, step: &Step, places: usize) {
        self.counters.meet(step.end(), &look.census, places);
        if self.counters.method_past_limit.is_none() {
            self.counters.method_past_limit = self.past_limit(look, step);
        }
    }

    /// What to say if the step's method is past the step length it is stable to.
    fn past_limit(&self, look: &Look, step: &Step) -> Option<String> {
        let Model::Tracked { method, substeps, .. } = self.viewer.model else { return None };
        let h = step.duration / f64::from(substeps.max(1));
        let x = (0..3)
            .map(|k| h * self.viewer.pigments[k].contraction(crate::units::Trolands(look.census.greatest[k]))[1])
            .fold(0.0, f64::max);
        (x > method.stable_to).then(|| {
            format!(
                "frame {}: h lambda reaches {x:.3}, past the {:.3} to which method {:?} is stable: its pigment is not to be trusted",
                step.number, method.stable_to, method.name
            )
        })
    }
}

/// The retina of a state file, which must be of the frames' size.
pub(crate) fn retina_of_file(config: &Config, file: &str, width: usize, height: usize) -> Result<Retina> {
    let path = config.path(file);
    let planes = frames::read_state(&path, config.settings.input.max_pixels)?;
    if (planes.width, planes.height) != (width, height) {
        let problem =
            format!("is a state of {} x {} places; the frames have {width} x {height}", planes.width, planes.height);
        return Err(Error::file(&path, problem));
    }
    let p = Array3::from_shape_fn((height, 3, width), |(y, k, x)| planes.at(x, y, k));
    if p.iter().any(|v| !(0.0..=1.0).contains(v)) {
        return Err(Error::file(&path, "holds unbleached fractions outside 0 to 1"));
    }
    Ok(Retina::from_fractions(p, [1.0; 3]))
}

/// Time spent in each stage.
#[derive(Clone, Copy, Debug, Default)]
struct Spent {
    decode: Duration,
    display: Duration,
    encode: Duration,
}

/// Runs the three stages side by side.
fn stages(
    config: &Config,
    scene: &Scene,
    eye: &mut Eye,
    folder: &Path,
    resume: Option<&Checkpoint>,
    watch: &dyn Watch,
) -> Result<Spent> {
    let writer = writer(config, scene, &eye.config, folder)?;
    let tables = Tables::open(folder, resume.map(|c| c.lengths))?;
    let steps = &scene.steps[eye.done..];
    let progress = (eye.done, scene.steps.len());
    let (to_eye, from_reader) = sync_channel(QUEUE);
    let (to_writer, from_eye) = sync_channel(QUEUE);
    let (give_back, spent_planes) = sync_channel(QUEUE + 2);
    let (give_back_seen, spent_seen) = sync_channel(QUEUE + 2);
    std::thread::scope(|threads| {
        let sequence = scene.sequence(eye.places_to_check());
        let reader = threads.spawn(move || reader::read_all(sequence, steps, &to_eye, &spent_planes));
        let writer = threads.spawn(move || writer.write_all(tables, &from_eye, &give_back_seen, watch, progress));
        let links = Links { from_reader: &from_reader, to_writer, give_back: &give_back, spent_seen: &spent_seen };
        let looked = look_at_all(config, scene, eye, links, watch);
        drop((from_reader, give_back));
        let decode = join(reader);
        let written = join(writer)?;
        looked?;
        Ok(Spent { decode, display: written.display, encode: written.encode })
    })
}

/// A stage's result; a stage that panicked (our bug) panics here.
fn join<T>(thread: std::thread::ScopedJoinHandle<'_, T>) -> T {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

/// The writer of a configuration's pictures.
pub(crate) fn writer<'a>(config: &Config, scene: &Scene, resolved: &Value, folder: &'a Path) -> Result<Writer<'a>> {
    let digest = digest(resolved.to_string().as_bytes());
    Ok(Writer {
        folder,
        display: scene.display(config),
        seen_to_srgb: scene.vision.seen_to_srgb.map(|row| row.map(|v| v as f32)),
        seen: config.settings.output.seen == SeenKey::Exr,
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

/// The eye's stage: every frame in order, checkpoints now and then.
fn look_at_all(config: &Config, scene: &Scene, eye: &mut Eye, links: Links<'_>, watch: &dyn Watch) -> Result<()> {
    let Links { from_reader, to_writer, give_back, spent_seen } = links;
    let every = Duration::from_secs_f64(config.settings.output.checkpoint_s);
    let adapted = config.settings.observer.start == "adapted";
    let mut last_checkpoint = Instant::now();
    let mut held: Option<usize> = None;
    while eye.done < scene.steps.len() {
        let step = &scene.steps[eye.done];
        let Ok(loaded) = from_reader.recv() else { return Ok(()) };
        let loaded = loaded?;
        if held != Some(step.file) {
            eye.counters.count(step.number, loaded.frame.tally);
            held = Some(step.file);
        }
        let last = eye.done + 1 == scene.steps.len();
        let first = adapted && eye.done == 0;
        let finished = eye.see(&loaded, step, first, last, spent_seen.try_recv().ok());
        if let Some(spent) = Arc::into_inner(loaded) {
            // A full queue only means that the planes are dropped here.
            let _ = give_back.try_send(spent.frame.planes);
        }
        if to_writer.send(Delivery::Frame(Box::new(finished))).is_err() {
            return Ok(());
        }
        let stop = watch.interrupted() && !last;
        if stop || (!last && last_checkpoint.elapsed() >= every) {
            last_checkpoint = Instant::now();
            if to_writer.send(Delivery::Checkpoint(Box::new(eye.checkpoint(&scene.steps)))).is_err() {
                return Ok(());
            }
        }
        if stop {
            return Err(Error::Interrupted { checkpoint: checkpoint::NAME.into() });
        }
    }
    Ok(())
}

/// Writes the report and the plot, and removes the checkpoint.
fn finish(
    config: &Config,
    scene: &Scene,
    eye: Eye,
    folder: &Path,
    spent: Spent,
    begun: Instant,
    watch: &dyn Watch,
) -> Result<Outcome> {
    plot::write(&folder.join("probes.svg"), &record::read_back(&folder.join("probes.csv"))?)?;
    film(config, scene, folder, watch)?;
    let mut warnings = scene.footage.header().notes.clone();
    for warning in eye.counters.warnings() {
        watch.warn(&warning);
        warnings.push(warning);
    }
    let failed = eye.check.as_ref().filter(|_| eye.viewer.plan.is_free());
    let failed = failed.and_then(|check| check.beyond(config.settings.numerics.budget));
    if let Some(warning) = &failed {
        watch.warn(warning);
        warnings.push(warning.clone());
    }
    let report = json!({
        "config": eye.config,
        "version": env!("CARGO_PKG_VERSION"),
        "constants": report::constants(config),
        "plan": eye.viewer.plan.report(eye.viewer.model, &eye.viewer.pigments),
        "check": eye.check.as_ref().map(Check::report),
        "frames": {
            "count": scene.steps.len(),
            "width": scene.footage.header().width,
            "height": scene.footage.header().height,
            "last_s": scene.steps.last().map(Step::end),
            "nan_samples": eye.counters.nan,
            "infinite_samples": eye.counters.infinite,
            "negative_samples": eye.counters.negative,
            "clipped_samples": eye.counters.clipped,
            "mended": eye.counters.mended_frames,
            "held": eye.counters.held_frames,
        },
        "warnings": warnings,
        "timing": {
            "decode_s": spent.decode.as_secs_f64(),
            "simulate_s": eye.busy.as_secs_f64(),
            "display_s": spent.display.as_secs_f64(),
            "encode_s": spent.encode.as_secs_f64(),
            "wall_s": begun.elapsed().as_secs_f64(),
        },
    });
    frames::atomic::write_text(&folder.join("report.json"), &format!("{report:#}\n"))?;
    Checkpoint::remove(folder)?;
    Ok(Outcome { report, went_on: eye.counters.went_on() || failed.is_some(), already: false })
}

/// Makes the film that `output.video` asks for, or says how to.
fn film(config: &Config, scene: &Scene, folder: &Path, watch: &dyn Watch) -> Result<()> {
    let output = &config.settings.output;
    if output.video == "none" {
        return Ok(());
    }
    if let Some(command) = video::make(folder, &output.video, &scene.steps)? {
        watch.warn(&format!("ffmpeg is not on the PATH; this makes the film where it is: {command}"));
    }
    Ok(())
}
