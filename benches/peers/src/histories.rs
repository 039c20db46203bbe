//! Light histories at 25 frames a second (a frame is then a whole number of every peer's fixed
//! steps), and the truth.

use std::fmt::Write;
use sungaze::kinetics::Kinetics;
use sungaze::units::{Seconds, Trolands};

/// One history: frames of 0.04 s with the light of each, td.
pub struct History {
    pub name: &'static str,
    pub lights: Vec<f64>,
    /// p at the end of every frame, by the convex form of the solution.
    pub truth: Vec<f64>,
}

pub const FRAME: Seconds = Seconds(0.04);

/// The constants of Psychtoolbox: 10^4.3 td, 120 s.
pub fn eye() -> Kinetics {
    Kinetics::first_order(Trolands(10f64.powf(4.3)), Seconds(120.0))
}

pub fn histories() -> Vec<History> {
    vec![
        history("indoor", &[(125, 300.0), (125, 1000.0)]),
        history("headlamp", &[(25, 1e3), (25, 1e7), (200, 1e3)]),
        history("sun-glance", &[(2, 300.0), (6, 1e10), (242, 300.0)]),
    ]
}

fn history(name: &'static str, parts: &[(usize, f64)]) -> History {
    let lights: Vec<f64> = parts.iter().flat_map(|&(count, light)| std::iter::repeat_n(light, count)).collect();
    let mut p = 1.0;
    let truth = lights.iter().map(|&light| {
        let kept = (-FRAME.0 * eye().rates(p, Trolands(light)).sum()).exp();
        p = kept * p + (1.0 - kept) * eye().steady(Trolands(light));
        p
    });
    History { name, truth: truth.collect(), lights }
}

/// `scene,light_td,p` for the scripts of the other languages.
pub fn table(histories: &[History]) -> String {
    let mut text = String::from("scene,light_td,p\n");
    for history in histories {
        for (light, p) in history.lights.iter().zip(&history.truth) {
            let _ = writeln!(text, "{},{light:e},{p:.17e}", history.name);
        }
    }
    text
}
