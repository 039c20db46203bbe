//! A look makes no room of its own: what it needs from frame to frame is there from the first one
//! on.

use sungaze::colour::Primaries;
use sungaze::eye::pigment::Model;
use sungaze::eye::{Eye, Stimulus, survey};
use sungaze::light::{Planes, Samples};
use sungaze::observer::{Directional, Observer, Reading, Steepness};
use sungaze::spectrum::Bands;
use sungaze::step;
use sungaze::units::{Degrees, Nits, Seconds};
use sungaze::vision::Vision;

const WIDTH: usize = 600;
const HEIGHT: usize = 40;
const PIXELS_PER_DEGREE: f64 = 24.0;

/// Allocations of the tenth to the twentieth look, which are at steps that differ in light, pupil
/// and length.
fn allocations(vision: Vision, mut planes: Planes, budget: Option<f64>) -> u64 {
    let model = Model::Tracked { method: step::EXACT, substeps: 0, budget: 1e-3 };
    let across = Degrees(WIDTH as f64 / PIXELS_PER_DEGREE);
    let eye = Eye::builder(vision, [WIDTH, HEIGHT], across).model(model, budget).build();
    let mut eye = eye.expect("an eye");
    let gaze = [WIDTH as f64 / 2.0, HEIGHT as f64 / 2.0];
    let mut look = |n: usize, planes: &mut Planes| -> u64 {
        if let Samples::Float(samples) = &mut planes.samples {
            samples.iter_mut().for_each(|v| *v *= 1.1);
        }
        let survey = survey(eye.vision(), planes, PIXELS_PER_DEGREE).into();
        let stimulus = Stimulus::new(planes, &survey);
        let counted = allocation_counter::measure(|| {
            let look = eye.look_at(stimulus, gaze, Seconds(0.02 + 0.01 * n as f64));
            eye.recycle(look.percept);
        });
        counted.count_total
    };
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    one_thread.install(|| {
        for n in 0..10 {
            look(n, &mut planes);
        }
        (10..20).map(|n| look(n, &mut planes)).sum()
    })
}

fn planes(count: usize) -> Planes {
    let samples = (0..WIDTH * HEIGHT * count).map(|i| (i % 101) as f32).collect();
    Planes { width: WIDTH, height: HEIGHT, count, samples: Samples::Float(samples) }
}

#[test]
fn a_look_allocates_nothing() {
    for reading in [Reading::Pupil, Reading::Paper { mm_per_degree: 0.29 }] {
        let mut observer = Observer::standard();
        observer.directional = Directional::new(reading, Steepness::LensCorrected);
        let bands = Bands::uniform(395.0, 705.0, 31).expect("31 bands");
        for budget in [None, Some(1e-3)] {
            let rgb =
                Vision::of_rgb(observer.clone(), &Primaries::REC709, Nits(100.0)).expect("a gamut");
            assert_eq!(allocations(rgb, planes(3), budget), 0, "RGB, {reading:?}");
            let held = Vision::of_held_bands(observer.clone(), &bands);
            assert_eq!(allocations(held, planes(31), budget), 0, "bands, {reading:?}");
            let projected = Vision::of_bands(observer.clone(), &bands);
            let count = projected.moment_count();
            assert_eq!(allocations(projected, planes(count), budget), 0, "moments, {reading:?}");
        }
    }
}
