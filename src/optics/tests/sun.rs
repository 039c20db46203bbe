//! The veil of a disc like the sun.

use super::*;
use crate::optics::double::veil_in_double;

/// A uniform disc of luminance 1 alone, each pixel the mean of 64 places, and its scale.
fn disc(width: usize, offset: f64) -> (Planes, f64) {
    let (height, degrees) = (width * 9 / 16, 8.0 / width as f64);
    let at = |i: usize, n: usize, part: usize| {
        ((i as f64 - (n as f64 - 1.0) / 2.0) + (part as f64 + 0.5) / 8.0 - 0.5) * degrees
    };
    let light = |x: usize, y: usize| {
        let inside = |part: &usize| {
            (at(x, width, part % 8) - offset).hypot(at(y, height, part / 8)) < RADIUS
        };
        (0..64).filter(inside).count() as f32 / 64.0
    };
    (picture([width, height], light), degrees)
}

/// Published integrals of the CIE equation over a disc of 0.533 degrees (age 30, brown eyes), at
/// degrees from its centre.
const DISC: [(f64, f64); 4] =
    [(0.5, 1.2705e-2), (1.0, 1.3853e-3), (2.0, 2.0097e-4), (3.0, 7.0059e-5)];

/// The veil in the middle row, degrees right of the picture's middle, between the columns by
/// powers.
fn veil_at(r: &Planes, degrees: f64, offset: f64, t: f64) -> f64 {
    let x = (t + offset) / degrees + (r.width as f64 - 1.0) / 2.0;
    let at = |x: usize| 0.5 * (r.at(x, (r.height - 1) / 2, 0) + r.at(x, r.height / 2, 0));
    let share = x.fract();
    (at(x as usize).ln() * (1.0 - share) + at(x as usize + 1).ln() * share).exp()
}

#[test]
fn the_veil_of_a_disc_is_the_integral_of_the_function_at_every_resolution() {
    for (width, tolerance) in [(120, 1.2e-2), (240, 1e-2), (480, 3e-3), (960, 3e-3)] {
        for offset in [0.0, 0.37 * 8.0 / width as f64] {
            let (s, degrees) = disc(width, offset);
            let r = exchanged(&mut optics(&cie(), [s.width, s.height], degrees, 3e-3), &s, None);
            for (t, expected) in &DISC[if width < 480 { 1 } else { 0 }..] {
                let found = veil_at(&r, degrees, offset, *t) / expected;
                assert!((found - 1.0).abs() < tolerance, "{width} pixels, {t} degrees: {found}");
            }
        }
    }
}

#[test]
fn a_sun_on_the_border_gives_a_far_sky_nothing_but_its_own_veil() {
    let (width, height, degrees) = (480, 270, 8.0 / 480.0);
    let r = |x: usize, y: usize| ((x as f64 + 0.5) * degrees).hypot((y as f64 - 134.5) * degrees);
    let s = picture([width, height], |x, y| if r(x, y) < RADIUS { 6.21e5 } else { 1000.0 });
    let mut optics = optics(&cie(), [width, height], degrees, 3e-3);
    let far = exchanged(&mut optics, &s, None).at(width - 1, 135, 0);
    assert!((1000.0..1003.0).contains(&far), "{far}");
}

#[test]
fn the_veil_of_the_sun_is_the_same_whatever_the_crop() {
    let at = |width: usize, height: usize| {
        let (degrees, middle) = (8.0 / 480.0, |n: usize| (n as f64 - 1.0) / 2.0);
        let r = |x: usize, y: usize| {
            (x as f64 - middle(width)).hypot(y as f64 - middle(height)) * degrees
        };
        let s = picture([width, height], |x, y| if r(x, y) < RADIUS { 6.2e5 } else { 0.0 });
        let r = exchanged(&mut optics(&cie(), [width, height], degrees, 3e-3), &s, None);
        veil_at(&r, degrees, 0.0, 2.0)
    };
    for width in [472, 476, 480, 484, 488] {
        let ratio = at(width, 270) / at(960, 540);
        assert!((ratio - 1.0).abs() < 1e-4, "{width}: {ratio}");
    }
}

/// The noon sun in its sky, 1 100 to 1.6e9 cd/m2.
fn noon(size: [usize; 2]) -> Planes {
    picture(size, |x, y| {
        let r = (x as f64 - 101.3).hypot(y as f64 - 60.8) / 30.0;
        if r < RADIUS { 1.6e9 } else { (1100.0 + 4e3 * (-r).exp()) as f32 }
    })
}

#[test]
fn single_floats_keep_the_veil_of_the_noon_sun_at_every_place() {
    let size = [240, 135];
    let s = noon(size);
    for depth in DEPTHS {
        let mut optics = Optics::at_depth(&cie(), size, 1.0 / 30.0, 1, depth).unwrap().unwrap();
        let r = exchanged(&mut optics, &s, None);
        let [veil, covered] =
            [&s, &picture(size, |_, _| 1.0)].map(|s| veil_in_double(&optics.sum, &depth, s));
        let exact = |i: usize| f64::from(floats(&s)[i]) * (1.0 - covered[i]) + veil[i];
        let errors = floats(&r).iter().enumerate().map(|(i, r)| f64::from(*r) / exact(i) - 1.0);
        let worst = errors.map(f64::abs).fold(0.0, f64::max);
        assert!(worst < ROUNDING, "{depth:?}: {worst:e}");
    }
}
