//! The light of a case: decoded once, surveyed, and reduced to what the contact sheet shows.

use std::sync::Arc;

use serde_json::Value;

use crate::config::Config;
use crate::error::Result;
use crate::eye;
use crate::light::Survey;
use crate::light::{Frame, Planes};
use crate::run::{self, Scene};
use crate::sweep::reduced;
use crate::vision::Projection;

/// One frame of light and its reduction.
pub struct Lit {
    pub planes: Planes,
    pub survey: Survey,
    pub small: Planes,
    /// Whether samples had to be mended.
    pub mended: bool,
}

/// Decodes a frame; `side` is the square that its reduction must fit into.
pub fn lit(scene: &Scene, file: usize, side: usize) -> Result<Arc<Lit>> {
    let Frame { planes, tally } = scene.footage.read(file, scene.vision.projection(), None)?;
    let survey = eye::survey(&scene.vision, &planes, scene.pixels_per_degree);
    let small = reduced::reduced(&planes, reduced::size([planes.width, planes.height], side));
    Ok(Arc::new(Lit { planes, survey, small, mended: tally.non_finite() > 0 }))
}

/// What two cases must have in common to see one decoded still.
#[derive(Clone, PartialEq)]
pub struct Key {
    input: Value,
    projection: Option<Projection>,
    luminance: Vec<f64>,
}

/// The key of a case's still.
pub fn key(config: &Config, scene: &Scene) -> Key {
    Key {
        input: run::resolved(&config.settings)["input"].clone(),
        projection: scene.vision.projection().cloned(),
        luminance: scene.vision.luminance.clone(),
    }
}
