//! The configuration as it is written: one struct a section, one field a key. The names are a
//! contract.

mod input;
mod observer;
mod sweep;

use serde::{Deserialize, Serialize};

use crate::display::{Ceiling, Tone};
use crate::eye::Surround;
use crate::frames::Overscan;
use crate::observer::Field;
use crate::optics::{Draw, Psf, Scatter};

use super::named;
pub use super::words::*;

pub(crate) use input::{BandRange, Channel, Channels, Input, OneOrMany};
pub(crate) use observer::ObserverKeys;
pub(super) use sweep::{MOST, SweepKeys, Values, Vary, Wrong};

/// A whole run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    pub input: Input,
    pub(crate) time: Time,
    pub gaze: Gaze,
    pub(crate) optics: OpticsKeys,
    pub observer: ObserverKeys,
    pub(crate) numerics: Numerics,
    pub(crate) display: DisplayKeys,
    pub(crate) output: Output,
    /// `[sweep]`, for `sungaze sweep` alone.
    #[serde(skip_serializing)]
    pub(crate) sweep: Option<SweepKeys>,
}

impl Settings {
    /// With what silence means written out: the built-in scene, the peak densities of the
    /// fundamentals.
    pub(super) fn completed(mut self) -> Self {
        let input = &mut self.input;
        if input.frames.is_none() {
            match *input.scene.get_or_insert_default() {
                Scene::Sunset => input.complete_sunset(),
                Scene::Field => input.complete_field(),
            }
        }
        let sunset = input.scene == Some(Scene::Sunset) && self.observer.preset == Preset::Standard;
        self.optics.psf.get_or_insert(if sunset { Psf::Cie } else { Psf::None });
        let observer = &mut self.observer;
        let field = if observer.field_deg == 2 { Field::TwoDegrees } else { Field::TenDegrees };
        observer.optical_density.get_or_insert(observer.fundamentals.optical_density(field));
        self
    }
}

/// `[time]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Time {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) interval_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) times_s: Option<Times>,
    /// Starts of a sequence's frames where `times_s` is `"gaze.path"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) frames_s: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) duration_s: Option<f64>,
}

/// `time.times_s`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(expecting = "a list of seconds, or \"gaze.path\"")]
pub(crate) enum Times {
    /// A frame ends at each row of the gaze path and holds that row's gaze.
    #[serde(rename = "gaze.path")]
    GazePath,
    #[serde(untagged)]
    Listed(Vec<f64>),
}

impl Time {
    /// Whether frames end at the rows of the gaze path.
    pub(crate) fn follows_the_gaze(&self) -> bool {
        matches!(self.times_s, Some(Times::GazePath))
    }

    /// The listed times of frames.
    pub(crate) fn listed(&self) -> Option<&[f64]> {
        match &self.times_s {
            Some(Times::Listed(times)) => Some(times),
            _ => self.frames_s.as_deref(),
        }
    }
}

/// `[gaze]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Gaze {
    pub at: Aim,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    pub(crate) fovea_deg: f64,
    pub(crate) surround_cd_m2: Surround,
}

impl Default for Gaze {
    fn default() -> Self {
        Gaze { at: Aim::At([0.5, 0.5]), path: None, fovea_deg: 2.0, surround_cd_m2: Surround::Edge }
    }
}

/// Where the eye looks: a fraction of width and height from the top left, or what it seeks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    rename_all = "kebab-case",
    expecting = "[x, y] as fractions of the picture, \"brightest\" or \"brightest-each\""
)]
pub enum Aim {
    /// The brightest place of the first frame.
    Brightest,
    /// That of each frame.
    BrightestEach,
    #[serde(untagged)]
    At([f64; 2]),
}

/// `[optics]`: what the eye scatters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct OpticsKeys {
    /// Absent: `cie` for the built-in scene, `none` for given frames and the paper's observer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) psf: Option<Psf>,
    pub(crate) core_deg: f64,
    pub(crate) straylight: f64,
    pub(crate) draw: Draw,
}

impl Default for OpticsKeys {
    fn default() -> Self {
        let Scatter { core_deg, straylight, .. } = Scatter::default();
        OpticsKeys { psf: None, core_deg, straylight, draw: Draw::Veiled }
    }
}

/// `[numerics]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Numerics {
    pub(crate) method: String,
    pub(crate) substeps: u32,
    pub(crate) model: ModelKey,
    pub(crate) budget: f64,
    pub(crate) light_budget: f64,
}

impl Default for Numerics {
    fn default() -> Self {
        Numerics {
            method: "exact".into(),
            substeps: 0,
            model: ModelKey::Auto,
            budget: 1e-3,
            light_budget: 3e-3,
        }
    }
}

/// `[display]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct DisplayKeys {
    #[serde(with = "named")]
    pub(crate) tone: Tone,
    pub(crate) ceiling: Ceiling,
    pub(crate) exposure_ev: f64,
    pub(crate) white_cd_m2: f64,
    #[serde(serialize_with = "infinity_as_word")]
    pub(crate) smoothing_s: f64,
    pub(crate) highlights: f64,
}

/// JSON has no infinity; a pinned map is written as the word that TOML uses.
fn infinity_as_word<S: serde::Serializer>(value: &f64, out: S) -> Result<S::Ok, S::Error> {
    if value.is_finite() { out.serialize_f64(*value) } else { out.serialize_str("inf") }
}

impl Default for DisplayKeys {
    fn default() -> Self {
        DisplayKeys {
            tone: named::first(),
            ceiling: Ceiling::default(),
            exposure_ev: 0.0,
            white_cd_m2: 100.0,
            smoothing_s: 0.5,
            highlights: 0.5,
        }
    }
}

/// `[output]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Output {
    pub(crate) seen: SeenKey,
    #[serde(with = "named")]
    pub(crate) keep: Overscan,
    pub(crate) display: DisplayFile,
    pub(crate) state: StateKey,
    pub(crate) video: String,
    #[serde(skip_serializing_if = "String::is_empty", deserialize_with = "input::word_or_number")]
    pub(crate) range: String,
    pub(crate) page: bool,
    /// Whether display pictures show the gaze and the time.
    pub(crate) marks: bool,
    /// Whether tables begin with the law and its constants, as a comment.
    pub(crate) law: bool,
    pub(crate) compression: String,
    pub(crate) checkpoint_s: f64,
    pub(crate) probe: Vec<Probe>,
}

impl Default for Output {
    fn default() -> Self {
        Output {
            seen: SeenKey::Exr,
            keep: named::first(),
            display: DisplayFile::Png,
            state: StateKey::Last,
            video: "none".into(),
            range: String::new(),
            page: true,
            marks: false,
            law: false,
            compression: "auto".into(),
            checkpoint_s: 30.0,
            probe: Vec::new(),
        }
    }
}

/// `[[output.probe]]`: a point of the picture traced through time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Probe {
    pub(crate) name: String,
    pub(crate) at: [f64; 2],
}
