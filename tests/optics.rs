//! The optics stage from outside: bits, what an eye sees of its veil, and a run with the check beside
//! it.

use std::path::Path;
use std::sync::Arc;

use sungaze::colour::Primaries;
use sungaze::config::Config;
use sungaze::eye::pigment::Model;
use sungaze::eye::{Eye, Look, Stimulus, survey};
use sungaze::light::{Planes, Samples};
use sungaze::observer::Observer;
use sungaze::optics::{Draw, Optics, Psf, Scatter};
use sungaze::run::{self, Existing, Unwatched};
use sungaze::units::{Degrees, Nits, Seconds};
use sungaze::vision::Vision;

/// Suns in a pattern, other in each plane.
fn picture(planes: &[usize]) -> Planes {
    let (width, height, count) = (701, 393, planes.len());
    let light = |plane: usize, at: usize| {
        if (at + 31 * plane).is_multiple_of(9973) { 1e8 } else { (at % 37) as f32 }
    };
    let runs = (0..height).flat_map(|y| planes.iter().map(move |plane| (*plane, y)));
    let samples = runs.flat_map(|(plane, y)| (0..width).map(move |x| light(plane, y * width + x)));
    Planes { width, height, count, samples: Samples::Float(samples.collect()) }
}

fn scattered(threads: usize, s: &Planes) -> Planes {
    let scatter = Scatter { psf: Psf::Cie, ..Scatter::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut out = Planes::float(0, 0, 0);
        let size = [s.width, s.height];
        let mut optics = Optics::new(&scatter, size, 0.05, s.count, 1e-3).unwrap().unwrap();
        optics.exchange(s, None, &mut out);
        out
    })
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let s = picture(&[0, 1, 2]);
    let one = scattered(1, &s);
    assert_eq!(scattered(2, &s), one);
    assert_eq!(scattered(5, &s), one);
}

#[test]
fn planes_are_scattered_alike_however_many_there_are() {
    let three = scattered(2, &picture(&[0, 1, 2]));
    for plane in 0..3 {
        let alone = scattered(2, &picture(&[plane]));
        let same = |x: usize, y: usize| alone.at(x, y, 0) == three.at(x, y, plane);
        assert!((0..393).all(|y| (0..701).all(|x| same(x, y))), "plane {plane}");
    }
}

/// A look of a second at the middle of a picture of 0.05 degrees a pixel.
fn look(model: Model, draw: Draw, s: &Planes) -> Look {
    let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, Nits(1.0)).unwrap();
    let of_s = Arc::new(survey(&vision, s, 20.0));
    let (size, across) = ([s.width, s.height], Degrees(0.05 * s.width as f64));
    let scatter = Scatter { psf: Psf::Cie, ..Scatter::default() };
    let optics = Optics::new(&scatter, size, 0.05, 3, 1e-3).unwrap();
    let eye = Eye::builder(vision, size, across).model(model, None).optics(optics, draw);
    let stimulus = Stimulus::new(s, &of_s);
    eye.build().unwrap().look_at(stimulus, [350.0, 196.0], Seconds(1.0))
}

#[test]
fn an_unbleached_eye_sees_the_light_on_its_retina_or_the_picture_itself() {
    let s = picture(&[0, 1, 2]);
    let veiled = look(Model::Unbleached, Draw::Veiled, &s);
    assert_eq!(veiled.percept, scattered(2, &s));
    let clear = look(Model::Unbleached, Draw::Clear, &s);
    assert_eq!(clear.percept, s);
    assert!(veiled.survey.least > clear.survey.least, "the display sees the veil");
    assert_eq!(veiled.pupil, clear.pupil, "the pupil sees the light before it");
}

#[test]
fn a_veil_that_is_not_drawn_bleaches_all_the_same() {
    let s = picture(&[0, 1, 2]);
    let model = Model::Tracked { method: sungaze::step::EXACT, substeps: 0, budget: 1e-4 };
    let [veiled, clear] = [Draw::Veiled, Draw::Clear].map(|draw| look(model, draw, &s));
    assert_eq!(veiled.stats.least, clear.stats.least);
    let dark = (0..393 * 701).find(|i| s.at(i % 701, i / 701, 0) == 0.0).unwrap();
    assert_eq!(clear.percept.at(dark % 701, dark / 701, 0), 0.0);
    assert!(veiled.percept.at(dark % 701, dark / 701, 0) > 0.0);
}

/// Of spectral frames the veil is known by its projections only.
#[test]
fn a_run_with_scatter_agrees_with_its_check_and_tells_what_scatter_may_cost() {
    let folder = tempfile::tempdir().unwrap();
    let text = "input.width = 96\ntime.times_s = [0, 0.5, 2, 10]\noutput.page = false";
    let config = Config::parse(text, "test", "test", Path::new(""), &[]).unwrap();
    let out = folder.path().join("out");
    run::run(&config, &out, Existing::Refuse, &Unwatched).unwrap();
    let report = std::fs::read_to_string(out.join("report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["config"]["optics"]["psf"], "cie");
    for error in ["max_error_p", "max_error_catch"] {
        let found = report["check"][error].as_f64().unwrap();
        assert!(found < 1e-3, "{error}: {found}");
    }
    let bound = report["plan"]["optics"]["bound_of_light"].as_f64().unwrap();
    assert!(bound > 0.0 && bound <= 3e-3, "{bound}");
}
