//! Light histories that tell methods apart. Light is held over each frame, but for `ramp`.

use crate::step::Drive;
use crate::units::{Seconds, Trolands};

/// A light history and the pigment it begins with.
pub(super) struct Scene {
    pub name: &'static str,
    /// What it is, in words for the chart.
    pub title: &'static str,
    pub start: f64,
    pub frames: Vec<(Drive, Seconds)>,
}

const FILM: f64 = 1.0 / 24.0;

/// The scenes of the work-precision chart.
pub(super) fn scenes() -> Vec<Scene> {
    vec![
        held("indoor", "indoor: 300 and 1000 td, 24 fps", FILM, &[(120, 300.0), (120, 1000.0)]),
        held("street", "street: 10⁵ td, 24 fps", FILM, &[(480, 1e5)]),
        held(
            "headlamp",
            "headlamp: 1 s of 10⁷ td, 24 fps",
            FILM,
            &[(24, 1e3), (24, 1e7), (240, 1e3)],
        ),
        held(
            "sun-glance",
            "sun glance: 6 frames of 10¹⁰ td",
            FILM,
            &[(2, 300.0), (6, 1e10), (240, 300.0)],
        ),
        held(
            "time-lapse",
            "time-lapse: 60 s steps, 10³ to 10⁵ td",
            60.0,
            &[(5, 1e3), (5, 1e4), (10, 1e5), (10, 1e3)],
        ),
        flicker(),
        Scene {
            start: 0.0,
            ..held("dark-recovery", "dark recovery: 20 min, 1 s steps", 1.0, &[(1200, 0.0)])
        },
        ramp(),
    ]
}

/// Frames of `interval` seconds: so many of each light, td.
fn held(name: &'static str, title: &'static str, interval: f64, lights: &[(usize, f64)]) -> Scene {
    let frames = lights.iter().flat_map(|&(count, light)| {
        std::iter::repeat_n((Drive::Held(Trolands(light)), Seconds(interval)), count)
    });
    Scene { name, title, start: 1.0, frames: frames.collect() }
}

/// The flicker of the oracle: 12 Hz between darkness and 2e6 td for 20 s.
fn flicker() -> Scene {
    let cycle = [2e6, 0.0].map(|light| (Drive::Held(Trolands(light)), Seconds(FILM)));
    Scene {
        name: "flicker",
        title: "flicker: 12 Hz, 2·10⁶ td and dark",
        start: 1.0,
        frames: cycle.repeat(240),
    }
}

/// Light that climbs and falls within frames, to peaks between 1e5 and 1e10 td. One of them, 5.5e8
/// td, makes h lambda = 4.8 on its way down: there holding the mean errs most.
fn ramp() -> Scene {
    let peaks = (0..=20).map(|i| 10f64.powf(5.0 + 0.25 * f64::from(i))).chain([5.53e8]);
    let frames = peaks.flat_map(|peak| {
        let [dark, peak] = [0.0, peak].map(Trolands);
        let way = [Drive::Ramp { from: dark, to: peak }, Drive::Ramp { from: peak, to: dark }];
        way.map(|drive| (drive, Seconds(FILM)))
    });
    Scene {
        name: "ramp",
        title: "ramp: light moves within the frame",
        start: 1.0,
        frames: frames.collect(),
    }
}
