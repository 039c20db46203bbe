//! `[observer]`: who looks.

use serde::{Deserialize, Serialize};

use crate::config::named;
use crate::config::words::Preset;
use crate::kinetics::Law;
use crate::observer::lens::TABULATED_AGE;
use crate::observer::{Narrowing, Reading, Rule, Set, Steepness};
use crate::optics::Scatter;

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
