//! sungaze

pub mod chart;
pub mod colour;
pub mod config;
pub mod constants;
pub mod display;
pub mod error;
pub mod eye;
pub mod frames;
pub mod kernel;
pub mod kinetics;
pub mod light;
pub mod percept;
pub mod retina;
pub mod run;
pub mod spectrum;
pub mod step;
pub mod sweep;
pub mod units;
pub mod viewer;
