//! A rehearsal: the frames go by the eye once and nothing is written, to learn what a run would
//! model and leave out.

use serde_json::{Value, json};

use super::reader::Frames;
use super::{Scene, Watching, resolved};
use crate::config::Config;
use crate::error::{Error, Result};
use crate::run::watch::Watch;

/// The plan of a configuration: the same terms that `report.json` of its run has, and what its
/// frames cost.
pub fn rehearse(config: &Config, watch: &dyn Watch) -> Result<Value> {
    let scene = Scene::open(config)?;
    let mut eye = Watching::new(config, &scene, resolved(&config.settings))?;
    let mut frames = Frames::new(scene.sequence(Some(Vec::new())));
    let mut recycled = None;
    for step in &scene.steps {
        let loaded = frames.of(step, || None)?;
        eye.note(&scene.steps, &loaded);
        recycled = Some(eye.see(&loaded, step, false, recycled).seen);
        watch.frames(eye.done, scene.steps.len());
        if watch.interrupted() {
            return Err(Error::Interrupted { resumable: false });
        }
    }
    let header = scene.footage.header();
    let megapixel_frames = (header.width * header.height * scene.steps.len()) as f64 / 1e6;
    let per_megapixel = |seconds: f64| 1e3 * seconds / megapixel_frames;
    let mut plan = eye.eye.plan_report();
    plan["frames"] = json!(scene.steps.len());
    plan["cost_ms_per_megapixel_frame"] = json!({
        "reading": per_megapixel(eye.timing.decode_s),
        "seeing": per_megapixel(eye.timing.simulate_s),
    });
    Ok(plan)
}
