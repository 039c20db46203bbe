//! Pictures in time on which the rungs of the ladder are compared.

use crate::colour::Primaries;
use crate::error::Result;
use crate::frames::builtin::Sunset;
use crate::frames::{Footage, Kind};
use crate::light::{Planes, Samples};
use crate::observer::Observer;
use crate::units::{Nits, Seconds};
use crate::vision::Projection;
use crate::vision::Vision;

/// A picture, or two that take turns, over a sequence of frames.
pub(super) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    pub(crate) vision: Vision,
    pub(crate) pictures: Vec<Planes>,
    /// Which picture each frame shows, and how long.
    pub(crate) frames: Vec<(usize, Seconds)>,
}

const WIDTH: usize = 320;
const HEIGHT: usize = 180;
const FILM: f64 = 1.0 / 24.0;

pub(super) fn scenes() -> Result<Vec<Scene>> {
    let dark_then_lamps =
        (0..72).map(|i| (usize::from((24..36).contains(&i)), Seconds(FILM))).collect();
    let day = (0..36).map(|i| (usize::from((12..24).contains(&i)), Seconds(1200.0))).collect();
    Ok(vec![
        rgb("indoor", "indoor, 2 to 4 cd/m², 24 fps", &[(3.0, 0.0)], still(48, FILM)),
        rgb("street", "street at noon, 5·10³ cd/m², 24 fps", &[(5e3, 3e4)], still(72, FILM)),
        rgb("headlamps", "headlamps for half a second", &[(1.0, 0.0), (1.0, 2e6)], dark_then_lamps),
        sunset()?,
        rgb("time-lapse", "a day, a frame every 20 min", &[(800.0, 0.0), (4e3, 2e4)], day),
    ])
}

fn still(count: usize, interval: f64) -> Vec<(usize, Seconds)> {
    vec![(0, Seconds(interval)); count]
}

/// Pictures that vary smoothly by a third about a level, with two discs of another luminance;
/// cd/m2.
fn rgb(
    name: &'static str,
    title: &'static str,
    levels: &[(f64, f64)],
    frames: Vec<(usize, Seconds)>,
) -> Scene {
    let white = Nits(1.0);
    let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, white);
    let vision = vision.unwrap_or_else(|| unreachable!("the primaries of Rec. 709 span a gamut"));
    let pictures = levels.iter().map(|&(level, disc)| picture(level, disc)).collect();
    Scene { name, title, vision, pictures, frames }
}

fn picture(level: f64, disc: f64) -> Planes {
    let mut samples = vec![0.0; WIDTH * HEIGHT * 3];
    for y in 0..HEIGHT {
        for plane in 0..3 {
            for x in 0..WIDTH {
                let (u, v) = (x as f64 / WIDTH as f64, y as f64 / HEIGHT as f64);
                let wave = (7.0 * u + 2.0 * plane as f64).sin() * (5.0 * v - plane as f64).cos();
                let near =
                    [0.35, 0.65].iter().any(|at| ((u - at) * 16.0).hypot((v - 0.55) * 9.0) < 0.5);
                let light = if near && disc > 0.0 { disc } else { level * (1.0 + wave / 3.0) };
                samples[(y * 3 + plane) * WIDTH + x] = light as f32;
            }
        }
    }
    Planes { width: WIDTH, height: HEIGHT, count: 3, samples: Samples::Float(samples) }
}

/// The built-in sunset as its bands, over a minute.
fn sunset() -> Result<Scene> {
    let footage = Sunset::new(WIDTH, 0.5, 2.5);
    let Kind::Spectral(bands) = &footage.header().kind else {
        unreachable!("the built-in sunset is spectral")
    };
    let planes = footage.read(0, Some(&Projection::identity(bands.len())), None)?.planes;
    let ends: Vec<f64> = (0..40).map(|i| FILM * (60.0 / FILM).powf(f64::from(i) / 39.0)).collect();
    let frames =
        (0..40).map(|i| (0, Seconds(ends[i] - if i > 0 { ends[i - 1] } else { 0.0 }))).collect();
    Ok(Scene {
        name: "sunset",
        title: "the built-in sunset, 31 bands, a minute",
        vision: Vision::of_held_bands(Observer::standard(), bands),
        pictures: vec![planes],
        frames,
    })
}
