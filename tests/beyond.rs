//! What lies beyond the picture: a surround of a known luminance, and the veil that an eye
//! scatters there.

use ndarray::{Array3, s};
use sungaze::colour::Primaries;
use sungaze::eye::{Eye, Gaze, Light, Surround};
use sungaze::observer::Observer;
use sungaze::optics::{Draw, Optics, Psf, Scatter};
use sungaze::spectrum::Bands;
use sungaze::units::{Degrees, Nits, Seconds};

const DEGREES: f64 = 0.1;

/// An eye that scatters, for pictures of this size.
fn eye(light: &Light, [width, height]: [usize; 2], surround: Nits) -> Eye {
    let vision = light.received_by(Observer::standard()).unwrap();
    let count = vision.plane_count();
    let scatter = Scatter { psf: Psf::Cie, ..Scatter::default() };
    let optics = Optics::new(&scatter, [width, height], DEGREES, count, 1e-3).unwrap();
    Eye::builder(vision, [width, height], Degrees(DEGREES * width as f64))
        .optics(optics, Draw::Veiled)
        .surround(Surround::Uniform(surround))
        .build()
        .unwrap()
}

fn grey() -> Light {
    Light::rgb(Primaries::REC709, Nits(1.0))
}

/// Of the planes of an equal-energy light at 1 cd/m2.
fn equal_energy(light: &Light, [width, height]: [usize; 2]) -> Array3<f32> {
    let vision = light.received_by(Observer::standard()).unwrap();
    let planes = match light {
        Light::Rgb { .. } => vision.equal_energy_planes(),
        Light::Bands(bands) => vec![1.0 / luminance_of_ones(bands); bands.len()],
    };
    Array3::from_shape_fn((height, width, planes.len()), |(_, _, i)| planes[i] as f32)
}

fn luminance_of_ones(bands: &Bands) -> f64 {
    let vision = Light::Bands(bands.clone()).received_by(Observer::standard()).unwrap();
    let projection = vision.projection().unwrap();
    let weights = vision.luminance.iter().enumerate();
    let of_band = |band: usize| -> f64 {
        weights.clone().map(|(i, w)| w * f64::from(projection.weight(i, band))).sum()
    };
    (0..bands.len()).map(of_band).sum()
}

#[test]
fn a_surround_as_bright_as_a_uniform_picture_leaves_its_light_as_it_is() {
    let bands = Light::Bands(Bands::uniform(390.0, 830.0, 44).unwrap());
    for light in [grey(), bands] {
        let frame = equal_energy(&light, [48, 32]) * 3e3;
        let mut eye = eye(&light, [48, 32], Nits(3e3));
        eye.look(frame.view(), Gaze::CENTRE, Seconds(1.0)).unwrap();
        let td = eye.trolands().unwrap();
        for k in 0..3 {
            let plane = td.slice(s![.., .., k]);
            let least = plane.fold(f32::INFINITY, |a, b| a.min(*b));
            let most = plane.fold(0.0f32, |a, b| a.max(*b));
            assert!(most / least - 1.0 < 2e-5, "cone {k}: {least} to {most} td");
        }
    }
}

/// A sun near the right border of a dim sky.
fn sun([width, height]: [usize; 2], at: [f64; 2]) -> Array3<f32> {
    let sky = equal_energy(&grey(), [width, height]) * 200.0;
    let inside = |x: usize, y: usize| (x as f64 - at[0]).hypot(y as f64 - at[1]) < 2.6;
    Array3::from_shape_fn(sky.dim(), |(y, x, i)| {
        sky[[y, x, i]] * if inside(x, y) { 2e6 } else { 1.0 }
    })
}

#[test]
fn places_beyond_the_picture_are_bleached_by_its_veil_as_places_of_a_wider_picture_are() {
    let (size, wide) = ([96, 64], [288, 192]);
    let small = sun(size, [72.0, 30.0]);
    let large = sun(wide, [72.0 + 96.0, 30.0 + 64.0]);
    let (mut ours, mut truth) = (eye(&grey(), size, Nits(200.0)), eye(&grey(), wide, Nits(200.0)));
    // A glance at the sky past the border first: some places of the retina join only later.
    let looks = [([0.5, 0.5], 4.0), ([0.9, 0.3], 3.0), ([0.1, 0.8], 2.0)];
    for (at, seconds) in looks {
        let wider = [0, 1].map(|i| (at[i] + 1.0) / 3.0);
        ours.look(small.view(), Gaze(at), Seconds(seconds)).unwrap();
        truth.look(large.view(), Gaze(wider), Seconds(seconds)).unwrap();
    }
    let (origin, [width, height]) = (ours.retina().origin(), ours.retina().size());
    assert!(width > size[0] && height > size[1]);
    let (mut worst, mut bleached) = (0.0f64, 0.0f64);
    for (y, x) in (0..height as i64).flat_map(|y| (0..width as i64).map(move |x| (y, x))) {
        let place = [origin[0] + x, origin[1] + y];
        let theirs = truth.retina().at([place[0] + 96, place[1] + 64]);
        let found = ours.retina().at(place);
        let beyond = place[0] < 0 || place[1] < 0 || place[0] > 95 || place[1] > 63;
        if beyond {
            worst = (0..3).map(|k| (found[k] - theirs[k]).abs()).fold(worst, f64::max);
            bleached = bleached.max(1.0 - theirs[0]);
        }
    }
    println!("bleached up to {bleached:.3}, worst {worst:.2e}");
    assert!(bleached > 0.1, "{bleached}");
    assert!(worst < 0.02 * bleached, "{worst:e} of {bleached}");
}

#[test]
fn a_state_goes_on_with_what_lies_beyond_to_the_bit() {
    let size = [96, 64];
    let frame = sun(size, [80.0, 20.0]);
    let looks = [[0.5, 0.5], [0.5, 0.5], [0.8, 0.2], [0.1, 0.9]];
    let mut whole = eye(&grey(), size, Nits(200.0));
    for at in looks {
        whole.look(frame.view(), Gaze(at), Seconds(1.0)).unwrap();
    }
    for stop in 1..looks.len() {
        let mut first = eye(&grey(), size, Nits(200.0));
        for at in &looks[..stop] {
            first.look(frame.view(), Gaze(*at), Seconds(1.0)).unwrap();
        }
        let mut second = eye(&grey(), size, Nits(200.0));
        second.restore(first.state()).unwrap();
        for at in &looks[stop..] {
            second.look(frame.view(), Gaze(*at), Seconds(1.0)).unwrap();
        }
        assert!(second.state() == whole.state(), "stopped after {stop}");
    }
}

#[test]
fn a_state_of_an_eye_without_scatter_is_refused_by_one_that_scatters() {
    let plain = Eye::new(grey(), [96, 64], Degrees(9.6)).unwrap();
    let refused = eye(&grey(), [96, 64], Nits(200.0)).restore(plain.state());
    assert!(refused.is_err());
}
