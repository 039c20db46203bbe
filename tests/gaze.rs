//! A moving gaze: the pigment belongs to a place on the retina, and the state is never resampled.

use proptest::prelude::*;

use sungaze::colour::Primaries;
use sungaze::eye::check;
use sungaze::eye::pigment::Model;
use sungaze::eye::{self, Eye, EyeBuilder, Stimulus, Surround};
use sungaze::kinetics::Kinetics;
use sungaze::light::{Planes, Samples};
use sungaze::observer::{Directional, Observer, Reading, Steepness};
use sungaze::step::Method;
use sungaze::units::{Degrees, Nits, Seconds, Trolands};
use sungaze::vision::Vision;

const WIDTH: usize = 12;
const HEIGHT: usize = 7;

fn builder(observer: Observer, model: Model) -> EyeBuilder {
    let vision = Vision::of_rgb(observer, &Primaries::REC709, Nits(1e4)).unwrap();
    let pigments = [Kinetics::first_order(Trolands(2e4), Seconds(120.0)); 3];
    let across = Degrees(WIDTH as f64 / 2.0);
    Eye::builder(vision, [WIDTH, HEIGHT], across)
        .pigments(pigments)
        .model(model, None)
        .surround(Surround::Uniform(Nits(0.0)))
}

fn eye(model: Model) -> Eye {
    builder(Observer::standard(), model).build().unwrap()
}

fn tracked() -> Model {
    Model::Tracked { method: Method::named("exact").unwrap(), substeps: 0, budget: 1e-3 }
}

fn picture(f: impl Fn(usize, usize, usize) -> f32) -> Planes {
    let mut planes = Planes::float(WIDTH, HEIGHT, 3);
    if let Samples::Float(samples) = &mut planes.samples {
        for y in 0..HEIGHT {
            for i in 0..3 {
                for x in 0..WIDTH {
                    samples[(y * 3 + i) * WIDTH + x] = f(x, y, i);
                }
            }
        }
    }
    planes
}

fn look_at(
    eye: &mut Eye,
    planes: &Planes,
    gaze: [f64; 2],
    checked: &[[usize; 2]],
) -> sungaze::eye::Look {
    let survey = eye::survey(eye.vision(), planes, eye.pixels_per_degree()).into();
    let stimulus = Stimulus { planes, survey: &survey, checked, spectra: None, uniform: None };
    eye.look_at(stimulus, gaze, Seconds(0.5))
}

fn look(eye: &mut Eye, planes: &Planes, gaze: [f64; 2]) -> Planes {
    look_at(eye, planes, gaze, &[]).percept
}

fn some_picture() -> Planes {
    picture(|x, y, i| ((x * 7 + y * 3 + i * 5) % 11) as f32 / 3.0)
}

proptest! {
    #[test]
    fn an_unbleached_eye_returns_its_picture_exactly_at_any_gaze(moves in prop::collection::vec((0.0..12.0f64, 0.0..7.0f64), 1..6)) {
        let mut eye = eye(Model::Unbleached);
        let light = some_picture();
        for (x, y) in moves {
            prop_assert_eq!(&look(&mut eye, &light, [x, y]), &light);
        }
    }

    #[test]
    fn a_drifting_gaze_over_a_dark_picture_leaves_the_state_as_a_still_one_does(moves in prop::collection::vec((0.0..12.0f64, 0.0..7.0f64), 1..6)) {
        let (mut still, mut drifting) = (eye(tracked()), eye(tracked()));
        let (light, dark) = (some_picture(), picture(|_, _, _| 0.0));
        for eye in [&mut still, &mut drifting] {
            look(eye, &light, [5.5, 3.0]);
        }
        for (x, y) in moves {
            look(&mut still, &dark, [5.5, 3.0]);
            look(&mut drifting, &dark, [x, y]);
        }
        let [a, b] = [&still, &drifting].map(|eye| eye.retina().first_view(WIDTH, HEIGHT));
        prop_assert_eq!(a, b);
    }
}

#[test]
fn a_whole_pixel_move_is_the_still_gaze_at_a_picture_moved_the_other_way() {
    let light = some_picture();
    let moved = picture(|x, y, i| if x + 2 < WIDTH { some_at(&light, x + 2, y, i) } else { 0.0 });
    let mut observer = Observer::standard();
    observer.pupil = sungaze::observer::Rule::Fixed(sungaze::units::Millimetres(3.0));
    let [mut a, mut b] = [(); 2].map(|()| builder(observer.clone(), tracked()).build().unwrap());
    let dark = picture(|_, _, _| 0.0);
    for eye in [&mut a, &mut b] {
        look(eye, &dark, [5.0, 3.0]);
    }
    look(&mut a, &light, [7.0, 3.0]);
    look(&mut b, &moved, [5.0, 3.0]);
    assert_eq!(a.retina().first_view(WIDTH, HEIGHT), b.retina().first_view(WIDTH, HEIGHT));
}

fn some_at(planes: &Planes, x: usize, y: usize, i: usize) -> f32 {
    planes.at(x, y, i) as f32
}

#[test]
fn looking_away_from_a_light_leaves_its_image_where_the_gaze_goes() {
    let sun = picture(|x, y, _| if (x, y) == (5, 3) { 1e5 } else { 0.01 });
    let wall = picture(|_, _, _| 1.0);
    let mut eye = eye(tracked());
    look(&mut eye, &sun, [5.0, 3.0]);
    let seen = look(&mut eye, &wall, [8.0, 4.0]);
    let at = |x: usize, y: usize| seen.at(x, y, 1);
    assert!(
        at(8, 4) < 0.2 * at(2, 2),
        "the after-image is at the gaze: {} against {}",
        at(8, 4),
        at(2, 2)
    );
    assert!((at(5, 3) / at(2, 2) - 1.0).abs() < 1e-2, "and not where the sun was");
}

#[test]
fn places_that_the_picture_reaches_anew_have_lived_through_no_frame_twice() {
    let light = some_picture();
    let start = || builder(Observer::standard(), tracked()).surround(Surround::Uniform(Nits(3e4)));
    let mut covering = sungaze::eye::retina::Retina::rested(WIDTH, HEIGHT);
    covering.cover([-12, -7], [24, 14], WIDTH);
    let (mut growing, mut grown) = (start().build().unwrap(), start().build().unwrap());
    grown.restore(growing.state().with_retina(covering)).unwrap();
    for gaze in [[5.0, 3.0], [8.5, 1.25], [2.0, 6.0], [0.0, 0.0]] {
        let [a, b] = [&mut growing, &mut grown].map(|eye| look(eye, &light, gaze));
        assert_eq!(a, b, "looking at {gaze:?}");
    }
}

/// The largest error of p that the sampled check finds over a moving gaze.
fn checked(method: &str, reading: Reading) -> f64 {
    let mut observer = Observer::standard();
    observer.directional = Directional::new(reading, Steepness::LensCorrected);
    let model =
        Model::Tracked { method: Method::named(method).unwrap(), substeps: 0, budget: 1e-3 };
    let mut eye =
        builder(observer, model).surround(Surround::Uniform(Nits(300.0))).build().unwrap();
    let light = some_picture();
    let places = check::places(eye.vision(), &light);
    for i in 0..8 {
        let gaze = [4.0 + 1.3 * f64::from(i), 3.0 - 0.7 * f64::from(i)];
        look_at(&mut eye, &light, gaze, &places);
    }
    eye.check().unwrap().largest()[0]
}

#[test]
fn the_sampled_check_goes_on_under_a_moving_gaze_and_finds_a_method_that_errs() {
    for reading in [Reading::Pupil, Reading::Paper { mm_per_degree: 0.29 }] {
        let (exact, euler) = (checked("exact", reading), checked("forward-euler", reading));
        assert!(exact < 1e-6 && euler > 1e-4, "{exact:e} {euler:e}");
    }
}
