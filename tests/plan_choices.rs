//! What `auto` leaves out, and that what it keeps is right.

use std::path::Path;

use sungaze::colour::Primaries;
use sungaze::config::Config;
use sungaze::eye::pigment::Model;
use sungaze::eye::plan::SUBSTEPS;
use sungaze::eye::{Eye, EyeBuilder, Look, Stimulus, Surround, survey};
use sungaze::kinetics::Kinetics;
use sungaze::light::{Planes, Samples};
use sungaze::observer::{Observer, Rule};
use sungaze::run::Scene;
use sungaze::spectrum::Bands;
use sungaze::step;
use sungaze::units::{Degrees, Millimetres, Nits, Seconds, Trolands};
use sungaze::vision::Vision;

const BUDGET: f64 = 1e-3;
const FRAME: Seconds = Seconds(1.0 / 24.0);

fn pigments() -> [Kinetics; 3] {
    [4.3, 4.3, 5.0].map(|log: f64| Kinetics::first_order(Trolands(10f64.powf(log)), Seconds(120.0)))
}

fn tracked() -> Model {
    Model::Tracked { method: step::EXACT, substeps: 0, budget: SUBSTEPS * BUDGET }
}

fn builder(vision: Vision, planes: &Planes, budget: Option<f64>) -> EyeBuilder {
    let across = Degrees(planes.width as f64 / 10.0);
    Eye::builder(vision, [planes.width, planes.height], across)
        .pigments(pigments())
        .model(tracked(), budget)
        .surround(Surround::Uniform(Nits(0.0)))
}

fn vision() -> Vision {
    let mut observer = Observer::standard();
    observer.pupil = Rule::Fixed(Millimetres(2.0));
    Vision::of_rgb(observer, &Primaries::REC709, Nits(1.0)).unwrap()
}

fn eye(planes: &Planes, budget: Option<f64>) -> Eye {
    builder(vision(), planes, budget).build().unwrap()
}

fn look_for(eye: &mut Eye, planes: &Planes, gaze: [f64; 2], duration: Seconds) -> Look {
    let survey = survey(eye.vision(), planes, 10.0).into();
    let stimulus = Stimulus::new(planes, &survey);
    eye.look_at(stimulus, gaze, duration)
}

fn look(eye: &mut Eye, planes: &Planes, gaze: [f64; 2]) -> Look {
    look_for(eye, planes, gaze, FRAME)
}

/// White light of so many cd/m2 at every column.
fn picture(width: usize, height: usize, white: impl Fn(usize) -> f32) -> Planes {
    let samples = (0..3 * width * height).map(|i| white(i % width)).collect();
    Planes { width, height, count: 3, samples: Samples::Float(samples) }
}

#[test]
fn under_a_moving_gaze_dim_tiles_stay_untouched_and_give_their_light_back_exactly() {
    let planes = picture(1000, 3, |x| if x < 700 { 1.0 + x as f32 / 700.0 } else { 1e6 });
    let mut free = eye(&planes, Some(BUDGET));
    let mut bound = eye(&planes, None);
    for i in 0..12 {
        let gaze = [500.0 + 3.7 * f64::from(i), 1.0 - 0.3 * f64::from(i)];
        let (ours, all) = (look(&mut free, &planes, gaze), look(&mut bound, &planes, gaze));
        for x in 0..1000 {
            for y in 0..3 {
                for k in 0..3 {
                    let (ours, all) = (ours.percept.at(x, y, k), all.percept.at(x, y, k));
                    assert!((ours / all - 1.0).abs() <= BUDGET, "{i} {x} {y} {k}: {ours} {all}");
                    assert!(x >= 400 || ours == planes.at(x, y, k));
                }
            }
        }
    }
    let report = free.plan_report();
    let (tiles, stepped) =
        (report["tiles"].as_u64().unwrap(), report["tiles_tracked"].as_u64().unwrap());
    assert!(stepped > 0 && stepped < tiles / 2 + 1, "{report}");
}

#[test]
fn every_reduction_is_reported_with_its_bound_and_its_reason_whether_it_was_taken_or_not() {
    for (white, model) in [(0.1, "none"), (1e5, "tracked")] {
        let planes = picture(8, 2, |_| white);
        let mut eye = eye(&planes, Some(BUDGET));
        look(&mut eye, &planes, [4.0, 1.0]);
        assert_eq!(eye.plan().name(tracked()), model);
        let terms = eye.plan().terms(tracked(), &pigments());
        let taken: Vec<&str> =
            terms.iter().filter(|term| term.chosen).map(|term| term.what).collect();
        assert_eq!(taken.contains(&"no bleaching anywhere"), model == "none");
        assert_eq!(taken.contains(&"the exact step"), model == "tracked");
    }
}

#[test]
fn what_ignoring_a_bright_moment_would_cost_is_not_forgotten_in_the_dark_after_it() {
    let (bright, dark) = (picture(8, 2, |_| 1e6), picture(8, 2, |_| 0.1));
    let mut eye = eye(&bright, Some(BUDGET));
    let seen = look(&mut eye, &bright, [4.0, 1.0]);
    let lost = 1.0 - eye.fractions_at(&seen, [4, 1])[0];
    for _ in 0..4 {
        look_for(&mut eye, &dark, [4.0, 1.0], Seconds(600.0));
    }
    assert!(eye.plan().bound_of_none(&pigments()).unwrap() >= lost && lost > 0.01);
}

#[test]
fn dim_rgb_is_promised_exactly_and_dim_spectra_to_single_precision() {
    let bands = Bands::uniform(395.0, 705.0, 5).unwrap();
    let spectral =
        Planes { width: 9, height: 2, count: 5, samples: Samples::Float(vec![1e-6; 90]) };
    let rgb = picture(9, 2, |_| 1e-3);
    let mut of_rgb = eye(&rgb, Some(BUDGET));
    let vision = Vision::of_held_bands(of_rgb.vision().observer.clone(), &bands);
    let mut of_bands = builder(vision, &spectral, Some(BUDGET)).build().unwrap();
    look(&mut of_bands, &spectral, [4.0, 1.0]);
    look(&mut of_rgb, &rgb, [4.0, 1.0]);
    let [exact, rounded] =
        [&of_rgb, &of_bands].map(|eye| eye.plan().bound(tracked(), &pigments()).unwrap());
    assert!(exact < 1e-6 && rounded > 1e-6, "{exact:e} {rounded:e}");
}

#[test]
fn a_dim_picture_in_a_dim_surround_is_left_untouched_wherever_the_gaze_goes() {
    let planes = picture(40, 3, |x| 0.1 + 0.01 * x as f32);
    let eye =
        builder(vision(), &planes, Some(BUDGET)).surround(Surround::Uniform(Nits(0.5))).build();
    let mut eye = eye.unwrap();
    for gaze in [[20.0, 1.0], [35.5, 0.25], [1.0, 2.0], [-70.0, 9.0], [20.0, 1.0]] {
        assert_eq!(look(&mut eye, &planes, gaze).percept, planes, "looking at {gaze:?}");
    }
    assert_eq!(eye.plan().name(tracked()), "none");
}

#[test]
fn a_bright_surround_has_bleached_the_places_that_the_picture_reaches() {
    let planes = picture(40, 3, |_| 0.1);
    let eye =
        builder(vision(), &planes, Some(BUDGET)).surround(Surround::Uniform(Nits(1e6))).build();
    let mut eye = eye.unwrap();
    look(&mut eye, &planes, [20.0, 1.0]);
    let seen = look(&mut eye, &planes, [30.0, 1.0]).percept;
    assert_eq!(seen.at(25, 1, 1), planes.at(25, 1, 1));
    assert!(
        seen.at(35, 1, 1) < 0.99 * planes.at(35, 1, 1)
            || seen.at(5, 1, 1) < 0.99 * planes.at(5, 1, 1)
    );
}

#[test]
fn a_budget_that_no_plan_can_keep_is_refused_and_the_least_is_told() {
    let set = |keys: &[&str]| {
        let text = "[input]\nscene = \"sunset\"\nwidth = 16\n";
        let keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
        let config = Config::parse(text, "c.toml", "c", Path::new(""), &keys).unwrap();
        Scene::open(&config).and_then(|scene| scene.eye(&config)).map(drop)
    };
    let refused = set(&["numerics.budget=1e-5"]).unwrap_err().to_string();
    assert!(refused.contains("numerics.budget") && refused.contains("accepted: "), "{refused}");
    let least = refused.split("accepted: ").nth(1).unwrap().split(' ').next().unwrap();
    set(&[&format!("numerics.budget={least}")]).unwrap();
    set(&["numerics.budget=1e-5", "numerics.model=tracked"]).unwrap();
}
