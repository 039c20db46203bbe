//! The configuration as it is written: one struct a section, one field a key. The names are a
//! contract.

use serde::{Deserialize, Serialize};

use crate::colour::Primaries;
use crate::display::{Ceiling, Tone};
use crate::eye::Surround;
use crate::frames::uniform;
use crate::frames::{
    Matrix, Missing, Negative, NonFinite, Overscan, Quantity, ReadOptions, Transfer,
    ViewProjection, Wanted,
};
use crate::kinetics::Law;
use crate::observer::lens::TABULATED_AGE;
use crate::observer::{Field, Narrowing, Reading, Rule, Set, Steepness};
use crate::optics::{Draw, Psf, Scatter};

use super::named;
pub use super::words::*;

pub(crate) use super::sweep::SweepKeys;

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

/// `[input]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Input {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<Scene>,
    /// Of a built-in scene; of frames, the most: wider ones are reduced.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) width: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) height: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) sun_elevation_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) turbidity: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) horizon: Option<Horizon>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) unit: Option<UnitKey>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) spectrum: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) level: Option<f64>,
    /// Seconds and level of each light, one after the other.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) schedule: Option<Vec<[f64; 2]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) repeat: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) history: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) frames: Option<OneOrMany>,
    #[serde(skip_serializing_if = "String::is_empty", deserialize_with = "word_or_number")]
    pub(crate) range: String,
    pub(crate) kind: Wanted,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub(crate) layer: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub white_cd_m2: Option<f64>,
    pub(crate) scale: f64,
    pub(crate) quantity: Quantity,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) channels: Option<Channels>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) bands_nm: Option<BandRange>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub horizontal_fov_deg: Option<f64>,
    /// The file's, or else angular.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub projection: Option<ViewProjection>,
    #[serde(with = "named")]
    pub(crate) primaries: Option<Primaries>,
    #[serde(with = "named")]
    pub(crate) transfer: Option<Transfer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) peak_cd_m2: Option<f64>,
    #[serde(with = "named")]
    pub(crate) matrix: Option<Matrix>,
    #[serde(with = "named")]
    pub(crate) code_range: Option<bool>,
    pub(crate) missing: Missing,
    pub(crate) non_finite: NonFinite,
    pub(crate) negative: Negative,
    pub max_pixels: u64,
}

impl Default for Input {
    fn default() -> Self {
        let read = ReadOptions::default();
        Input {
            scene: None,
            width: None,
            height: None,
            sun_elevation_deg: None,
            turbidity: None,
            horizon: None,
            unit: None,
            spectrum: None,
            level: None,
            schedule: None,
            repeat: None,
            history: None,
            frames: None,
            range: String::new(),
            kind: read.wanted,
            layer: String::new(),
            white_cd_m2: None,
            scale: read.scale,
            quantity: read.quantity,
            channels: None,
            bands_nm: None,
            horizontal_fov_deg: None,
            projection: None,
            primaries: read.primaries,
            transfer: read.transfer,
            peak_cd_m2: read.peak_cd_m2,
            matrix: read.matrix,
            code_range: read.full_range,
            missing: Missing::default(),
            non_finite: read.non_finite,
            negative: read.negative,
            max_pixels: read.max_pixels,
        }
    }
}

impl Input {
    fn complete_sunset(&mut self) {
        self.width.get_or_insert(480);
        self.sun_elevation_deg.get_or_insert(0.5);
        self.turbidity.get_or_insert(2.5);
        self.horizon.get_or_insert_default();
    }

    fn complete_field(&mut self) {
        self.width.get_or_insert(16);
        self.height.get_or_insert(16);
        self.horizontal_fov_deg.get_or_insert(uniform::FIELD_DEG);
        self.unit.get_or_insert_default();
        if self.history.is_none() {
            self.spectrum.get_or_insert_with(|| "equal-energy".into());
        }
    }
}

/// A range, of which one frame may be written as a number.
fn word_or_number<'de, D: serde::Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged, expecting = "a range of frames such as \"1001-1100\"")]
    enum Either {
        Word(String),
        Number(u32),
    }
    Ok(match Either::deserialize(from)? {
        Either::Word(word) => word,
        Either::Number(number) => number.to_string(),
    })
}

/// A pattern, or a list of files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a file name or pattern, or a list of file names")]
pub(crate) enum OneOrMany {
    One(String),
    Many(Vec<String>),
}

/// How unrecognised channel names map to wavelengths.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "a pattern with {nm}, a pattern with {index} beside bands_nm, or a list of { name, centre_nm, width_nm }"
)]
pub(crate) enum Channels {
    Pattern(String),
    Listed(Vec<Channel>),
}

/// One channel by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Channel {
    pub name: String,
    pub(crate) centre_nm: f64,
    pub(crate) width_nm: f64,
}

/// The range that indexed bands share evenly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BandRange {
    pub(crate) from: f64,
    pub(crate) to: f64,
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

/// `[observer]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ObserverKeys {
    pub(crate) preset: Preset,
    pub(crate) field_deg: u32,
    pub fundamentals: Set,
    #[serde(with = "named")]
    pub pupil: Rule,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) pupil_mm: Option<f64>,
    pub(crate) age: f64,
    pub(crate) pigmentation: f64,
    pub(crate) eyes: u8,
    pub(crate) pupil_delay_s: f64,
    pub(crate) pupil_closing_s: f64,
    pub(crate) pupil_opening_s: f64,
    #[serde(with = "named")]
    pub stiles_crawford: Reading,
    pub stiles_crawford_p: Steepness,
    pub(crate) mm_per_degree: f64,
    pub(crate) constants: String,
    #[serde(with = "named")]
    pub(crate) kinetics: Law,
    pub half_bleach_log_td: [f64; 3],
    pub tau_s: [f64; 3],
    pub(crate) km: f64,
    /// Absent: that of the fundamentals and the field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) optical_density: Option<[f64; 3]>,
    pub narrowing: Narrowing,
    pub(crate) start: String,
}

impl Default for ObserverKeys {
    fn default() -> Self {
        ObserverKeys {
            preset: Preset::Standard,
            field_deg: 2,
            fundamentals: Set::Cie2006,
            pupil: named::first(),
            pupil_mm: None,
            age: TABULATED_AGE,
            pigmentation: Scatter::default().pigmentation,
            eyes: 2,
            pupil_delay_s: 0.0,
            pupil_closing_s: 0.0,
            pupil_opening_s: 0.0,
            stiles_crawford: named::first(),
            stiles_crawford_p: Steepness::Measured,
            mm_per_degree: 0.29,
            constants: "standard".into(),
            kinetics: named::first(),
            half_bleach_log_td: [4.3, 4.3, 5.0],
            tau_s: [120.0; 3],
            km: 0.2,
            optical_density: None,
            narrowing: Narrowing::Depleted,
            start: "rested".into(),
        }
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
    #[serde(skip_serializing_if = "String::is_empty", deserialize_with = "word_or_number")]
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
