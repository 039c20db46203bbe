//! sungaze

pub mod display;
pub mod error;
pub mod frames;
pub mod light;
pub mod spectrum;
pub mod units;
