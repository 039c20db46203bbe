//! A rehearsal: the frames go by the eye once and nothing is written, to learn what a run would
//! model and leave out.

use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::reader::Loaded;
use super::{Scene, Watching, resolved};
use crate::config::Config;
use crate::error::{Error, Result};
use crate::run::watch::Watch;

/// The plan of a configuration: the same terms that `report.json` of its run has, and what its
/// frames cost.
pub fn rehearse(config: &Config, watch: &dyn Watch) -> Result<Value> {
    let scene = Scene::open(config)?;
    let mut eye = Watching::new(config, &scene, resolved(&config.settings))?;
    let mut sequence = scene.sequence(Some(Vec::new()));
    let (mut reading, mut last): (Duration, Option<(usize, Arc<Loaded>)>) = (Duration::ZERO, None);
    let mut recycled = None;
    for (i, step) in scene.steps.iter().enumerate() {
        let loaded = match &last {
            Some((file, loaded)) if *file == step.file => loaded.clone(),
            _ => {
                let begun = Instant::now();
                let old = last
                    .take()
                    .and_then(|(_, loaded)| Arc::into_inner(loaded))
                    .map(|old| old.frame.planes);
                let loaded = sequence.load(step.file, old)?;
                reading += begun.elapsed();
                Arc::new(loaded)
            }
        };
        recycled = Some(eye.see(&loaded, step, false, recycled).seen);
        last = Some((step.file, loaded));
        watch.frames(i + 1, scene.steps.len());
        if watch.interrupted() {
            return Err(Error::Interrupted { resumable: false });
        }
    }
    let header = scene.footage.header();
    let megapixel_frames = (header.width * header.height * scene.steps.len()) as f64 / 1e6;
    let per_megapixel = |time: Duration| 1e3 * time.as_secs_f64() / megapixel_frames;
    let mut plan = eye.eye.plan_report();
    plan["frames"] = json!(scene.steps.len());
    plan["cost_ms_per_megapixel_frame"] = json!({ "reading": per_megapixel(reading), "seeing": per_megapixel(Duration::from_secs_f64(eye.timing.simulate_s)) });
    Ok(plan)
}
