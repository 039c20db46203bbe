//! What scatter costs a frame: a look with optics and one without, in turns, medians.
//!
//! `cargo bench --bench optics`

use std::time::{Duration, Instant};

use half::f16;
use std::sync::Arc;
use sungaze::colour::Primaries;
use sungaze::eye::{Eye, Stimulus, survey};
use sungaze::light::{Planes, Samples};
use sungaze::observer::Observer;
use sungaze::optics::{Draw, Optics, Psf, Scatter};
use sungaze::units::{Degrees, Nits, Seconds};
use sungaze::vision::Vision;

const TURNS: usize = 9;
const ACROSS: f64 = 40.0;

fn picture(size: [usize; 2], count: usize) -> Planes {
    let light = |i: usize| if i.is_multiple_of(99_991) { 6e4 } else { (i % 97) as f32 };
    let samples = (0..size[0] * size[1] * count).map(|i| f16::from_f32(light(i))).collect();
    Planes { width: size[0], height: size[1], count, samples: Samples::Half(samples) }
}

fn optics(size: [usize; 2], count: usize, budget: f64) -> Option<Optics> {
    let scatter = Scatter { psf: Psf::Cie, ..Scatter::default() };
    Optics::new(&scatter, size, ACROSS / size[0] as f64, count, budget).expect("little straylight")
}

fn median(mut times: Vec<Duration>) -> f64 {
    times.sort();
    1e3 * times[times.len() / 2].as_secs_f64()
}

/// Medians of several works in turns, ms.
fn in_turns(works: &mut [Box<dyn FnMut() + '_>]) -> Vec<f64> {
    let mut times = vec![Vec::new(); works.len()];
    for turn in 0..=TURNS {
        for (work, times) in works.iter_mut().zip(&mut times) {
            let begun = Instant::now();
            work();
            // The first turn warms up.
            times.extend((turn > 0).then(|| begun.elapsed()));
        }
    }
    times.into_iter().map(median).collect()
}

/// A look at a new frame each time.
fn look(size: [usize; 2], budget: Option<f64>, held: bool) -> Box<dyn FnMut()> {
    let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, Nits(100.0));
    let vision = vision.expect("Rec. 709 has a gamut");
    let optics = budget.and_then(|budget| optics(size, 3, budget));
    let eye = Eye::builder(vision.clone(), size, Degrees(ACROSS)).optics(optics, Draw::Veiled);
    let (mut eye, planes) = (eye.build().expect("an eye"), picture(size, 3));
    if held {
        eye.hold_gaze();
    }
    let of_frame = survey(&vision, &planes, size[0] as f64 / ACROSS);
    Box::new(move || {
        let survey = Arc::new(of_frame.clone());
        let stimulus = Stimulus::new(&planes, &survey);
        let look = eye.look_at(stimulus, [100.0, 100.0], Seconds(1.0 / 24.0));
        eye.recycle(look.percept);
    })
}

fn main() {
    for size in [[960, 540], [1920, 1080], [3840, 2160]] {
        let ways = [None, Some(1.3e-2), Some(3.2e-3), Some(2e-4)].map(|budget| (budget, true));
        let mut looks: Vec<_> = ways.map(|(budget, held)| look(size, budget, held)).into();
        looks.push(look(size, Some(3.2e-3), false));
        let times = in_turns(&mut looks);
        let more: Vec<String> = times[1..].iter().map(|t| format!("{:.1}", t - times[0])).collect();
        println!(
            "{size:?}, half RGB: a look {:.1} ms; with light budgets 1.3e-2, 3.2e-3, 2e-4, and 3.2e-3 for a gaze that may move: + {} ms",
            times[0],
            more.join(", ")
        );
    }
    let size = [1920, 1080];
    let mut stages = [3, 12].map(|count| {
        let (mut optics, s) = (optics(size, count, 3e-3), picture(size, count));
        let mut out = Planes::float(0, 0, 0);
        Box::new(move || {
            optics.iter_mut().for_each(|optics| optics.exchange(&s, None, &mut out));
        }) as Box<dyn FnMut()>
    });
    let times = in_turns(&mut stages);
    println!("the stage alone, 1080p: 3 planes {:.1} ms, 12 planes {:.1} ms", times[0], times[1]);
}
