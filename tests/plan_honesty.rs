//! A plan promises only what its bound covers: 200 random scenes against the full model.

use sungaze::colour::Primaries;
use sungaze::eye::pigment::Model;
use sungaze::eye::plan::SUBSTEPS;
use sungaze::eye::{Eye, Stimulus, survey};
use sungaze::kinetics::{Kinetics, Law};
use sungaze::light::{Planes, Samples};
use sungaze::observer::{Observer, Rule};
use sungaze::spectrum::Curve;
use sungaze::step;
use sungaze::units::{Degrees, Millimetres, Nits, Seconds, Trolands};
use sungaze::vision::Vision;

const WIDTH: usize = 40;
const HEIGHT: usize = 25;
const BUDGET: f64 = 1e-3;

/// Numbers that look like chance and are always the same (splitmix64).
struct Chance(u64);

impl Chance {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// A scene: light from 1 to 1e10 td, steps from a millisecond to ten minutes, any law.
struct Scene {
    pigments: [Kinetics; 3],
    frames: Vec<(Planes, Seconds)>,
}

fn scene(chance: &mut Chance) -> Scene {
    let (_, law) = Law::NAMES[(chance.unit() * Law::NAMES.len() as f64) as usize];
    let law = law.with(0.4, 0.2);
    let pigment =
        |log: f64| Kinetics { law, half_bleach: Trolands(10f64.powf(log)), tau: Seconds(120.0) };
    let (dimmest, decades) = (chance.between(0.0, 8.0), chance.between(0.1, 2.0));
    let count = 1 + (chance.unit() * 6.0) as usize;
    let log_step = chance.between(-3.0, 600f64.log10());
    let frames = (0..count).map(|_| {
        // White of 1 cd/m2 through 2 mm of pupil is 3.14 td.
        let mut light = |_| 10f64.powf(dimmest + decades * chance.unit() - 0.5);
        let mut samples: Vec<f32> = (0..WIDTH * HEIGHT * 3).map(|i| light(i) as f32).collect();
        samples.iter_mut().skip(77).step_by(501).for_each(|v| *v *= 10.0);
        (
            Planes { width: WIDTH, height: HEIGHT, count: 3, samples: Samples::Float(samples) },
            log_step,
        )
    });
    let frames = frames.map(|(planes, log)| (planes, Seconds(10f64.powf(log)))).collect();
    Scene { pigments: [4.3, 4.3, 5.0].map(pigment), frames }
}

fn vision() -> Vision {
    let mut observer = Observer::standard();
    observer.pupil = Rule::Fixed(Millimetres(2.0));
    Vision::of_rgb(observer, &Primaries::REC709, Nits(1.0)).unwrap()
}

/// The largest error of p or of a catch over the scene, and what the plan promised.
fn error_and_bound(vision: &Vision, scene: &Scene) -> (f64, f64) {
    let model = Model::Tracked { method: step::EXACT, substeps: 0, budget: SUBSTEPS * BUDGET };
    let mut eye = Eye::builder(vision.clone(), [WIDTH, HEIGHT], Degrees(WIDTH as f64 / 10.0))
        .pigments(scene.pigments)
        .model(model, Some(BUDGET))
        .build()
        .unwrap();
    let mut truth = vec![[1.0; 3]; WIDTH * HEIGHT];
    let mut worst: f64 = 0.0;
    for (planes, dt) in &scene.frames {
        let survey = survey(vision, planes, 10.0).into();
        let stimulus = Stimulus::new(planes, &survey);
        let look = eye.look_at(stimulus, [20.0, 12.0], *dt);
        let weights = vision.illuminance_weights(look.pupil, Millimetres(0.0));
        for (i, p) in truth.iter_mut().enumerate() {
            let at = [i % WIDTH, i / WIDTH];
            let moments = vision.moments(planes, at[0], at[1]);
            let td = vision.illuminance(&moments, &weights);
            *p = [0, 1, 2]
                .map(|k| step::advance(&scene.pigments[k], p[k], Trolands(td[k]), *dt, 48));
            let ours = eye.fractions_at(&look, at);
            worst = (0..3).map(|k| (ours[k] - p[k]).abs()).fold(worst, f64::max);
            if i % 100 == 0 {
                worst = worst.max(error_of_catch(vision, planes, at, ours, *p));
            }
        }
    }
    (worst, eye.plan().bound(model, &scene.pigments).unwrap())
}

fn error_of_catch(
    vision: &Vision,
    planes: &Planes,
    [x, y]: [usize; 2],
    ours: [f64; 3],
    p: [f64; 3],
) -> f64 {
    let mut radiance = Curve::sampled(|_| 0.0);
    for (i, basis) in vision.basis().iter().enumerate() {
        radiance.0.iter_mut().zip(&basis.0).for_each(|(sum, b)| *sum += planes.at(x, y, i) * b);
    }
    let exact = vision.observer.catch(&radiance, p);
    let seen = vision.catch(&vision.moments(planes, x, y), ours);
    (0..3).map(|k| (seen[k] / exact[k] - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn no_error_exceeds_its_bound_and_half_of_the_bounds_are_within_thirty_times_of_it() {
    let (vision, mut chance) = (vision(), Chance(7));
    let mut ratios = Vec::new();
    for number in 0..200 {
        let scene = scene(&mut chance);
        let (error, bound) = error_and_bound(&vision, &scene);
        assert!(error <= bound, "scene {number}: {error:e} measured, {bound:e} promised");
        assert!(bound <= BUDGET, "scene {number}: {bound:e} promised");
        if error > 1e-6 {
            ratios.push(bound / error);
        }
    }
    ratios.sort_by(f64::total_cmp);
    assert!(
        ratios.len() > 50 && ratios[ratios.len() / 2] < 30.0,
        "{} of {}",
        ratios[ratios.len() / 2],
        ratios.len()
    );
}
