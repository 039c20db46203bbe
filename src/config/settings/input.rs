//! `[input]`: what is looked at.

use serde::{Deserialize, Deserializer, Serialize, de::Error};
use toml::Value;

use crate::colour::Primaries;
use crate::config::named;
use crate::config::words::{Horizon, Scene, UnitKey};
use crate::frames::uniform;
use crate::frames::{
    Matrix, Missing, Negative, NonFinite, Quantity, ReadOptions, Transfer, ViewProjection, Wanted,
};

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
    pub(super) fn complete_sunset(&mut self) {
        self.width.get_or_insert(480);
        self.sun_elevation_deg.get_or_insert(0.5);
        self.turbidity.get_or_insert(2.5);
        self.horizon.get_or_insert_default();
    }

    pub(super) fn complete_field(&mut self) {
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
pub(super) fn word_or_number<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    match Value::deserialize(from)? {
        Value::String(word) => Ok(word),
        Value::Integer(number @ 0..) => Ok(number.to_string()),
        _ => Err(D::Error::custom("a range of frames such as \"1001-1100\"")),
    }
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
