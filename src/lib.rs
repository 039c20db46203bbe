//! sungaze

pub mod chart;
pub mod error;
pub mod frames;
pub mod kinetics;
pub mod light;
pub mod spectrum;
pub mod step;
pub mod units;
