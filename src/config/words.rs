//! The words that keys accept: closed sets, which an error message lists.

use serde::{Deserialize, Serialize};

macro_rules! words {
    ($($(#[$doc:meta])* $name:ident { $($(#[$word:meta])* $variant:ident),* } default $default:ident)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum $name { $($(#[$word])* $variant),* }

        impl Default for $name {
            fn default() -> Self {
                $name::$default
            }
        }
    )*};
}

words! {
    /// The scenes without a file: a low sun, or a uniform field.
    Scene { Sunset, Field } default Sunset
    /// `input.unit`: of a field's level. Trolands are at the retina.
    UnitKey { Td, #[serde(rename = "cd_m2")] CdM2 } default Td
    /// What lies under its horizon.
    Horizon { Sea } default Sea
    /// `observer.preset`.
    Preset { Standard, Paper } default Standard
    /// `numerics.model`.
    ModelKey { Auto, None, Steady, Tracked } default Auto
    /// `output.seen`.
    SeenKey { Exr, None } default Exr
    /// `output.display`.
    DisplayFile { Png, None } default Png
    /// `output.state`.
    StateKey { Every, Last, None } default Last
}
