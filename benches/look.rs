//! One look after the other at a 1080p float RGB frame in memory: `cargo bench --bench look -- COUNT`.
//!
//! It prints nothing to compare by itself: `benches/peers/look.py` takes its processor time, in turns
//! with the same look from Python, NumPy and JAX.

use ndarray::Array3;
use sungaze::colour::Primaries;
use sungaze::eye::pigment::Model;
use sungaze::eye::{Eye, Gaze, Light};
use sungaze::observer::Observer;
use sungaze::step;
use sungaze::units::{Degrees, Nits, Seconds};

const SIZE: [usize; 2] = [1920, 1080];

fn main() -> sungaze::error::Result<()> {
    let count = std::env::args().find_map(|word| word.parse().ok()).unwrap_or(10);
    // The frame of `look.py`: a sky that brightens towards one side.
    let frame = Array3::from_shape_fn((SIZE[1], SIZE[0], 3), |(y, x, i)| {
        (0.1 + (x % 251) as f32 * 0.004 + (y % 127) as f32 * 0.002) * (1.0 + i as f32 * 0.1)
    });
    let light = Light::rgb(Primaries::REC709, Nits(20_000.0));
    let vision = light.received_by(Observer::standard())?;
    let model = Model::Tracked { method: step::EXACT, substeps: 0, budget: 1e-3 };
    let mut eye = Eye::builder(vision, SIZE, Degrees(40.0)).model(model, None).build()?;
    let mut sum = 0.0;
    for _ in 0..count {
        let look = eye.look(frame.view(), Gaze::CENTRE, Seconds(1.0 / 24.0))?;
        sum += look.percept.at(960, 540, 1);
        eye.recycle(look.percept);
    }
    println!("{count} looks, mean green {:.6}", sum / f64::from(count));
    Ok(())
}
