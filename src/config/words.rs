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
    /// `input.primaries`: of RGB whose file does not say them, or says others.
    PrimariesKey {
        Auto, Bt709, #[serde(rename = "bt601-525")] Bt601Of525, #[serde(rename = "bt601-625")] Bt601Of625, Bt2020,
        P3D65, P3Dci, Acescg, #[serde(rename = "aces2065-1")] Aces
    } default Auto
    /// `input.matrix`: of a film's YUV.
    MatrixKey { Auto, Bt601, Bt709, Bt2020Ncl } default Auto
    /// `input.code_range`: of a film's codes.
    CodeRangeKey { Auto, Limited, Full } default Auto
    /// `observer.preset`.
    Preset { Standard, Paper } default Standard
    /// `observer.pupil`.
    PupilKey { WatsonYellott, MoonSpencer, MoonSpencerAsPrinted, DeGrootGebhard, DeGrootGebhardAsPrinted, Fixed } default WatsonYellott
    /// `observer.stiles_crawford`.
    DirectionalKey { Pupil, Paper, Off } default Pupil
    /// `observer.kinetics`.
    LawKey { FirstOrder, SelfScreened, RateLimited } default FirstOrder
    /// `numerics.model`.
    ModelKey { Auto, None, Steady, Tracked } default Auto
    /// `display.tone`.
    ToneKey { Ward, Exposure } default Ward
    /// `output.seen`.
    SeenKey { Exr, None } default Exr
    /// `output.keep`.
    KeepKey { All, None } default All
    /// `output.display`.
    DisplayFile { Png, None } default Png
    /// `output.state`.
    StateKey { Every, Last, None } default Last
}

words! {
    /// What the gaze seeks: the brightest place of the first frame, or of each.
    Seek { Brightest, BrightestEach } default Brightest
}

words! {
    /// A published curve of p(lambda).
    SteepWord { Measured, LensCorrected } default Measured
}
