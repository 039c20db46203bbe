//! What `auto` leaves out, and that what it keeps is right.

use sungaze::colour::Primaries;
use sungaze::eye::plan::{Plan, SUBSTEPS};
use sungaze::eye::retina::{Model, Retina};
use sungaze::eye::{Look, Viewer, survey};
use sungaze::kinetics::Kinetics;
use sungaze::light::{Planes, Samples};
use sungaze::observer::{Observer, Rule};
use sungaze::spectrum::Bands;
use sungaze::step::{self, Method};
use sungaze::units::{Millimetres, Nits, Seconds, Trolands};
use sungaze::vision::Vision;

const BUDGET: f64 = 1e-3;
const FRAME: Seconds = Seconds(1.0 / 24.0);

fn pigments() -> [Kinetics; 3] {
    [4.3, 4.3, 5.0].map(|log: f64| Kinetics::first_order(Trolands(10f64.powf(log)), Seconds(120.0)))
}

fn tracked() -> Model {
    Model::Tracked {
        method: Method::named("exact").unwrap(),
        substeps: 0,
        budget: SUBSTEPS * BUDGET,
    }
}

fn viewer(planes: &Planes, plan: Plan) -> Viewer {
    let mut observer = Observer::standard();
    observer.pupil = Rule::Fixed(Millimetres(2.0));
    let vision = Vision::of_rgb(observer, &Primaries::REC709, Nits(1.0)).unwrap();
    let mut viewer = Viewer::new(
        vision,
        pigments(),
        tracked(),
        Retina::rested(planes.width, planes.height),
        10.0,
    );
    viewer.plan = plan;
    viewer
}

fn look(viewer: &mut Viewer, planes: &Planes, gaze: [f64; 2]) -> Look {
    let luminances = survey(&viewer.vision, planes, 10.0);
    viewer.look(planes, &luminances, gaze, FRAME, None)
}

/// White light of so many cd/m2 at every column.
fn picture(width: usize, height: usize, white: impl Fn(usize) -> f32) -> Planes {
    let samples = (0..3 * width * height).map(|i| white(i % width)).collect();
    Planes { width, height, count: 3, samples: Samples::Float(samples) }
}

/// The greatest error of p, relative to p, after some looks at the same picture.
fn error(viewer: &Viewer, planes: &Planes, look: &Look, looks: u32) -> f64 {
    let weights = viewer.vision.illuminance_weights(look.pupil, Millimetres(0.0));
    let of_place = |x: usize| {
        let td = viewer.vision.illuminance(&viewer.vision.moments(planes, x, 0), &weights);
        let ours = viewer.fractions_at([0.0; 2], [x, 0]);
        let of_cone = |k: usize| {
            let step = |p: f64| step::advance(&pigments()[k], p, Trolands(td[k]), FRAME, 1);
            let p = (0..looks).fold(1.0, |p, _| step(p));
            (ours[k] / p - 1.0).abs()
        };
        (0..3).map(of_cone).fold(0.0, f64::max)
    };
    (0..planes.width).map(of_place).fold(0.0, f64::max)
}

#[test]
fn a_crop_of_nothing_but_the_sun_is_steady_at_video_rate() {
    let planes = picture(300, 2, |x| 3e9 + 1e7 * x as f32);
    let mut viewer = viewer(&planes, Plan::new(Some(BUDGET)));
    let seen = look(&mut viewer, &planes, [150.0, 1.0]);
    assert_eq!(viewer.plan.name(tracked()), "steady");
    let (error, bound) =
        (error(&viewer, &planes, &seen, 1), viewer.plan.bound(tracked(), &pigments()).unwrap());
    assert!(error <= bound && bound <= BUDGET, "{error:e} {bound:e}");
}

#[test]
fn where_the_sun_is_only_part_of_a_tile_it_is_followed() {
    let planes = picture(300, 2, |x| if x == 17 { 3e3 } else { 3e9 });
    let mut viewer = viewer(&planes, Plan::new(Some(BUDGET)));
    let seen = (0..3).map(|_| look(&mut viewer, &planes, [150.0, 1.0])).last().unwrap();
    assert_eq!(viewer.plan.name(tracked()), "tracked");
    assert!(error(&viewer, &planes, &seen, 3) <= BUDGET);
}

#[test]
fn at_least_as_bright_as_that_and_a_little_dimmer_the_bound_holds() {
    // Around the light from which a frame outlasts memory (2e4 td: 1.2e9 td, S 6e9), in steps of 5
    // %.
    for i in 0..80 {
        let white = 1e8 * 1.05f32.powi(i);
        let planes = picture(3, 1, |_| white);
        let mut viewer = viewer(&planes, Plan::new(Some(BUDGET)));
        let seen = look(&mut viewer, &planes, [1.0, 0.0]);
        let bound = viewer.plan.bound(tracked(), &pigments()).unwrap();
        let error = error(&viewer, &planes, &seen, 1);
        assert!(error <= bound && bound <= BUDGET, "{white:e}: {error:e} {bound:e}");
    }
}

#[test]
fn under_a_moving_gaze_dim_tiles_stay_untouched_and_give_their_light_back_exactly() {
    let planes = picture(1000, 3, |x| if x < 700 { 1.0 + x as f32 / 700.0 } else { 1e6 });
    let mut free = viewer(&planes, Plan::new(Some(BUDGET)));
    let mut bound = viewer(&planes, Plan::new(None));
    for i in 0..12 {
        let gaze = [500.0 + 3.7 * f64::from(i), 1.0 - 0.3 * f64::from(i)];
        let (ours, all) = (look(&mut free, &planes, gaze), look(&mut bound, &planes, gaze));
        for x in 0..1000 {
            for y in 0..3 {
                for k in 0..3 {
                    let (ours, all) = (ours.seen.at(x, y, k), all.seen.at(x, y, k));
                    assert!((ours / all - 1.0).abs() <= BUDGET, "{i} {x} {y} {k}: {ours} {all}");
                    assert!(x >= 400 || ours == planes.at(x, y, k));
                }
            }
        }
    }
    let report = free.plan.report(tracked(), &pigments());
    let (tiles, stepped) =
        (report["tiles"].as_u64().unwrap(), report["tiles_tracked"].as_u64().unwrap());
    assert!(stepped > 0 && stepped < tiles / 2 + 1, "{report}");
}

#[test]
fn every_reduction_is_reported_with_its_bound_and_its_reason_whether_it_was_taken_or_not() {
    for (white, model) in [(0.1, "none"), (1e5, "tracked")] {
        let planes = picture(8, 2, |_| white);
        let mut viewer = viewer(&planes, Plan::new(Some(BUDGET)));
        look(&mut viewer, &planes, [4.0, 1.0]);
        assert_eq!(viewer.plan.name(tracked()), model);
        let terms = viewer.plan.terms(tracked(), &pigments());
        assert_eq!(terms.len(), 7);
        assert!(terms.iter().all(|term| !term.why.is_empty()));
        let taken: Vec<&str> =
            terms.iter().filter(|term| term.chosen).map(|term| term.what).collect();
        assert_eq!(taken.contains(&"no bleaching anywhere"), model == "none");
        assert_eq!(taken.contains(&"the exact step"), model == "tracked");
        let sum: f64 =
            terms.iter().filter(|term| term.chosen).map(|term| term.bound.unwrap()).sum();
        assert_eq!(viewer.plan.bound(tracked(), &pigments()), Some(sum));
    }
}

#[test]
fn what_ignoring_a_bright_moment_would_cost_is_not_forgotten_in_the_dark_after_it() {
    let (bright, dark) = (picture(8, 2, |_| 1e6), picture(8, 2, |_| 0.1));
    let mut viewer = viewer(&bright, Plan::new(Some(BUDGET)));
    look(&mut viewer, &bright, [4.0, 1.0]);
    let lost = 1.0 - viewer.fractions_at([0.0; 2], [4, 1])[0];
    for _ in 0..4 {
        let luminances = survey(&viewer.vision, &dark, 10.0);
        viewer.look(&dark, &luminances, [4.0, 1.0], Seconds(600.0), None);
    }
    assert!(viewer.plan.bound_of_none(&pigments()).unwrap() >= lost && lost > 0.01);
}

#[test]
fn dim_rgb_is_promised_exactly_and_dim_spectra_to_single_precision() {
    let bands = Bands::uniform(395.0, 705.0, 5).unwrap();
    let spectral =
        Planes { width: 9, height: 2, count: 5, samples: Samples::Float(vec![1e-6; 90]) };
    let rgb = picture(9, 2, |_| 1e-3);
    let mut of_rgb = viewer(&rgb, Plan::new(Some(BUDGET)));
    let vision = Vision::of_held_bands(of_rgb.vision.observer.clone(), &bands);
    let mut of_bands = Viewer::new(vision, pigments(), tracked(), Retina::rested(9, 2), 10.0);
    of_bands.plan = Plan::new(Some(BUDGET));
    look(&mut of_bands, &spectral, [4.0, 1.0]);
    look(&mut of_rgb, &rgb, [4.0, 1.0]);
    let [exact, rounded] =
        [&of_rgb, &of_bands].map(|viewer| viewer.plan.bound(tracked(), &pigments()).unwrap());
    assert!(exact < 1e-6 && rounded > 1e-6, "{exact:e} {rounded:e}");
}

#[test]
fn light_of_which_a_step_remembers_nothing_at_all_is_still_said_to_be_steady() {
    let planes = picture(300, 2, |_| 3e12);
    let mut viewer = viewer(&planes, Plan::new(Some(BUDGET)));
    look(&mut viewer, &planes, [150.0, 1.0]);
    assert_eq!(viewer.plan.name(tracked()), "steady");
    let terms = viewer.plan.terms(tracked(), &pigments());
    let steady = terms.iter().find(|term| term.chosen && term.what.starts_with("steady"));
    assert_eq!(steady.and_then(|term| term.bound), Some(0.0));
}

#[test]
fn a_dim_picture_in_a_dim_surround_is_left_untouched_wherever_the_gaze_goes() {
    let planes = picture(40, 3, |x| 0.1 + 0.01 * x as f32);
    let mut viewer = viewer(&planes, Plan::new(Some(BUDGET)));
    viewer.surround = Nits(0.5);
    for gaze in [[20.0, 1.0], [35.5, 0.25], [1.0, 2.0], [-70.0, 9.0], [20.0, 1.0]] {
        assert_eq!(look(&mut viewer, &planes, gaze).seen, planes, "looking at {gaze:?}");
    }
    assert_eq!(viewer.plan.name(tracked()), "none");
}

#[test]
fn a_bright_surround_has_bleached_the_places_that_the_picture_reaches() {
    let planes = picture(40, 3, |_| 0.1);
    let mut viewer = viewer(&planes, Plan::new(Some(BUDGET)));
    viewer.surround = Nits(1e6);
    look(&mut viewer, &planes, [20.0, 1.0]);
    let seen = look(&mut viewer, &planes, [30.0, 1.0]).seen;
    assert_eq!(seen.at(25, 1, 1), planes.at(25, 1, 1));
    assert!(
        seen.at(35, 1, 1) < 0.99 * planes.at(35, 1, 1)
            || seen.at(5, 1, 1) < 0.99 * planes.at(5, 1, 1)
    );
}
