//! Published catches and percepts, and what the levels of p err by.

use super::*;
use crate::light::Samples;
use crate::observer::{Directional, Field, Narrowing, Reading, Set, Steepness};

fn white_rgb(observer: Observer) -> Vision {
    Vision::of_rgb(observer, &Primaries::REC709, Nits(1.0)).unwrap()
}

fn pixel(rgb: [f32; 3]) -> Planes {
    Planes { width: 1, height: 1, count: 3, samples: Samples::Float(rgb.to_vec()) }
}

#[test]
fn srgb_has_the_published_catches() {
    // CIE 2006, 2 degrees, white = 1 cd/m2: C(1) = T^-1.
    let expected = [
        [0.26764312, 0.68193472, 0.06235848],
        [0.08036041, 0.70251130, 0.08374734],
        [0.00986564, 0.06083202, 0.48511176],
    ];
    let vision = white_rgb(Observer::standard());
    for j in 0..3 {
        let mut rgb = [0.0; 3];
        rgb[j] = 1.0;
        let catch = vision.catch(&vision.moments(&pixel(rgb), 0, 0), [1.0; 3]);
        for k in 0..3 {
            assert!((catch[k] - expected[k][j]).abs() < 1e-7, "{k}{j}: {catch:?}");
        }
    }
}

#[test]
fn bleached_white_and_red_are_seen_as_published() {
    let vision = white_rgb(Observer::standard());
    let cases = [
        ([1.0; 3], [0.5; 3], [0.609382, 0.598608, 0.565047]),
        ([1.0; 3], [0.01, 0.02, 0.8], [0.047469, -0.086010, 0.974012]),
        ([1.0, 0.0, 0.0], [0.1, 0.3, 0.9], [0.044929, 0.029471, 0.014309]),
    ];
    for (light, p, expected) in cases {
        let catch = vision.catch(&vision.moments(&pixel(light), 0, 0), p);
        let seen = colour::apply(&vision.lms_to_seen, catch);
        let error = (0..3).map(|i| (seen[i] - expected[i]).abs()).fold(0.0, f64::max);
        assert!(error < 3e-4, "{p:?}: {seen:?}");
    }
}

#[test]
fn no_percept_of_the_standard_observers_has_a_negative_luminance() {
    for field in [Field::TenDegrees, Field::TwoDegrees] {
        let directional = Directional::new(Reading::Off, Steepness::Measured);
        let (set, narrowing) = (Set::Cie2006, Narrowing::Depleted);
        let density = set.optical_density(field);
        let vision = white_rgb(Observer::new(set, field, density, narrowing, directional));
        let y = colour::rgb_to_xyz(&Primaries::REC709).unwrap()[1];
        // Next to nothing left of L and M, all of S: blue beyond any light, and not black.
        let seen = colour::apply(&vision.lms_to_seen, [1e-3, 1e-3, 0.1]);
        let luminance: f64 = y.iter().zip(seen).map(|(w, v)| w * v).sum();
        assert!(luminance > 0.0, "{field:?}: {luminance}");
    }
}

/// The largest relative error of a catch of any laser through any pigment.
fn worst_of_lasers(narrowing: Narrowing) -> (f64, Vision) {
    let mut observer = Observer::standard();
    observer.narrowing = narrowing;
    let vision = Vision::of_bands(observer.clone(), &Bands::uniform(389.5, 830.5, 441).unwrap());
    let rows = weighting_curves(&observer);
    let mut worst = 0.0f64;
    for nm in (0..441).step_by(7) {
        let mut light = Curve::sampled(|_| 0.0);
        light.0[nm] = 1.0;
        let moments: Vec<f64> = rows.iter().map(|r| observer.lumens_per_watt * r.0[nm]).collect();
        for p in [1e-6, 0.01, 0.1, 0.21, 0.33, 0.5, 0.8, 0.9, 0.999] {
            let direct = observer.catch(&light, [p; 3]);
            let ours = vision.catch(&moments, [p; 3]);
            let errors = ours.iter().zip(direct).map(|(ours, exact)| (ours / exact - 1.0).abs());
            worst = errors.fold(worst, f64::max);
        }
    }
    (worst, vision)
}

#[test]
fn levels_keep_every_catch_within_their_bound_and_need_it() {
    let (worst, vision) = worst_of_lasers(Narrowing::Depleted);
    let bound = vision.levels_bound();
    assert!(worst < bound && worst > 0.9 * bound, "{worst:e} {bound:e}");
}

#[test]
fn the_narrowed_reading_errs_by_more_than_one_sum_and_at_most_by_two() {
    let (worst, vision) = worst_of_lasers(Narrowing::Narrowed);
    let bound = vision.levels_bound();
    assert!(worst < bound && worst > 0.6 * bound, "{worst:e} {bound:e}");
}

#[test]
fn a_ten_nanometre_equal_energy_field_is_one_troland_within_a_percent() {
    let mut observer = Observer::standard();
    observer.directional = crate::observer::Directional::new(
        crate::observer::Reading::Off,
        crate::observer::Steepness::Measured,
    );
    let luminance = observer.lumens_per_watt * observer.luminous_efficiency().integral();
    let centres: Vec<f64> = (0..31).map(|i| 400.0 + 10.0 * i as f64).collect();
    let vision = Vision::of_bands(observer, &Bands::from_centres(&centres).unwrap());
    let projection = vision.projection().unwrap();
    let mut moments = vec![0.0f32; projection.rows];
    projection.project(&[(1.0 / luminance) as f32; 31], &mut moments);
    let moments: Vec<f64> = moments.into_iter().map(f64::from).collect();
    let pupil = Millimetres(4.0);
    let td = vision.illuminance(&moments, &vision.illuminance_weights(pupil, Millimetres(0.0)));
    for cone in td {
        assert!((cone / crate::observer::pupil::area(pupil) - 1.0).abs() < 0.01, "{td:?}");
    }
}
