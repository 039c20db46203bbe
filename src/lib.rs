//! sungaze

pub mod colour;
pub mod error;
pub mod eye;
pub mod frames;
pub mod light;
pub mod percept;
pub mod spectrum;
pub mod units;
