//! Light histories that tell methods apart. Light is held over each frame, but for `ramp`.

use crate::step::Drive;
use crate::units::{Seconds, Trolands};

/// A light history and the pigment it begins with.
pub(super) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) start: f64,
    pub(crate) frames: Vec<(Drive, Seconds)>,
}

const FILM: f64 = 1.0 / 24.0;

/// The scenes of the work-precision chart.
pub(super) fn scenes() -> Vec<Scene> {
    let dark = Scene { start: 0.0, ..held("dark-recovery", 1.0, &[(1200, 0.0)]) };
    vec![
        held("indoor", FILM, &[(120, 300.0), (120, 1000.0)]),
        held("street", FILM, &[(480, 1e5)]),
        held("headlamp", FILM, &[(24, 1e3), (24, 1e7), (240, 1e3)]),
        held("sun-glance", FILM, &[(2, 300.0), (6, 1e10), (240, 300.0)]),
        held("time-lapse", 60.0, &[(5, 1e3), (5, 1e4), (10, 1e5), (10, 1e3)]),
        flicker(),
        dark,
        ramp(),
    ]
}

/// Frames of `interval` seconds: so many of each light, td.
fn held(name: &'static str, interval: f64, lights: &[(usize, f64)]) -> Scene {
    let frames = lights.iter().flat_map(|&(count, light)| {
        std::iter::repeat_n((Drive::Held(Trolands(light)), Seconds(interval)), count)
    });
    Scene { name, start: 1.0, frames: frames.collect() }
}

/// The flicker of the oracle: 12 Hz between darkness and 2e6 td for 20 s.
fn flicker() -> Scene {
    let cycle = [2e6, 0.0].map(|light| (Drive::Held(Trolands(light)), Seconds(FILM)));
    Scene { name: "flicker", start: 1.0, frames: cycle.repeat(240) }
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
    Scene { name: "ramp", start: 1.0, frames: frames.collect() }
}
