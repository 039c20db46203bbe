//! The light of a case, decoded and surveyed once for all cases that see the same.

use std::sync::Arc;

use serde_json::Value;

use crate::config::Config;
use crate::error::Result;
use crate::run::{self, Loaded, Scene};
use crate::vision::Projection;

/// Decodes a frame. `places`: those to check; `None`: such as the frame suggests.
pub(super) fn lit(
    scene: &Scene,
    file: usize,
    places: Option<Vec<[usize; 2]>>,
) -> Result<Arc<Loaded>> {
    scene.sequence(places).load(file, None).map(Arc::new)
}

/// What two cases must have in common to see one decoded still.
#[derive(Clone, PartialEq)]
pub(super) struct Key {
    input: Value,
    projection: Option<Projection>,
    luminance: Vec<f64>,
}

/// The key of a case's still.
pub(super) fn key(config: &Config, scene: &Scene) -> Key {
    Key {
        input: run::resolved(&config.settings)["input"].clone(),
        projection: scene.vision.projection().cloned(),
        luminance: scene.vision.luminance.clone(),
    }
}
