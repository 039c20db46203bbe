//! Units as one-field types, for public boundaries. Inner loops unwrap them once.

use serde::{Deserialize, Serialize};

macro_rules! unit {
    ($(#[$doc:meta])* $name:ident, $symbol:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, concat!("{} ", $symbol), self.0)
            }
        }
    };
}

unit!(
    /// Time, s.
    Seconds, "s"
);
unit!(
    /// Wavelength in vacuum, nm.
    Nanometres, "nm"
);
unit!(
    /// Length, mm: pupil diameters and distances in the plane of the pupil.
    Millimetres, "mm"
);
unit!(
    /// Angle in the visual field, degrees.
    Degrees, "deg"
);
unit!(
    /// Luminance, cd/m2.
    Nits, "cd/m2"
);
unit!(
    /// Retinal illuminance, td: luminance in cd/m2 times pupil area in mm2.
    Trolands, "td"
);

/// Lumens per watt: the constant between watts and lumens at the peak of V (CIE 018:2019).
pub(crate) const LUMENS_PER_WATT: f64 = 683.002;
