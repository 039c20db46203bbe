//! Light scattered in the eye: the point spread functions, the veil of a disc, and what it bleaches.

use std::f64::consts::PI;

use crate::error::{Error, Result};
use crate::eye::Stimulus;
use crate::frames::builtin::FIELD_DEG;
use crate::kinetics::Kinetics;
use crate::light::{Planes, Samples};
use crate::optics::{Optics, Psf, Scatter};
use crate::run::Scene;
use crate::step::advance;
use crate::units::{Seconds, Trolands};

use super::{Check, Subject};

pub(super) fn checks(subject: &Subject) -> Result<Vec<Check>> {
    let mut checks = functions();
    checks.extend(disc()?);
    checks.extend(bleached_disc());
    checks.extend(pigment(subject)?);
    Ok(checks)
}

fn person(psf: Psf, age: f64, pigmentation: f64) -> Scatter {
    Scatter { psf, age, pigmentation, ..Scatter::default() }
}

/// Values of the functions at angles, and the share of the light that goes over the hemisphere.
fn functions() -> Vec<Check> {
    let cie = "CIE 135/1-1999, eq. 8";
    let values = [
        ("CIE total, age 20, dark eyes", cie, person(Psf::Cie, 20.0, 0.0), 1.0, 18.52),
        ("CIE total, age 20, dark eyes", cie, person(Psf::Cie, 20.0, 0.0), 10.0, 0.05498),
        ("CIE total, age 30, brown eyes", cie, person(Psf::Cie, 30.0, 0.5), 0.1, 11_430.0),
        ("CIE total, age 30, brown eyes", cie, person(Psf::Cie, 30.0, 0.5), 1.0, 18.96),
        ("CIE total, age 30, brown eyes", cie, person(Psf::Cie, 30.0, 0.5), 10.0, 0.06149),
        ("CIE total, age 80, blue eyes", cie, person(Psf::Cie, 80.0, 1.0), 1.0, 28.52),
        ("CIE total, age 80, blue eyes", cie, person(Psf::Cie, 80.0, 1.0), 30.0, 0.02621),
        ("CIE general", "CIE 146:2002", person(Psf::CieGeneral, 30.0, 0.5), 1.0, 15.319),
        (
            "Stiles-Holladay, age 70",
            "CIE 146:2002",
            person(Psf::StilesHolladay, 70.0, 0.5),
            10.0,
            0.2,
        ),
        ("Spencer, photopic", "Spencer et al. 1995", person(Psf::Spencer, 30.0, 0.5), 1.0, 19.02),
        ("IJspeert, 3 mm", "IJspeert et al. 1993", person(Psf::Ijspeert, 30.0, 0.5), 0.1, 9_246.0),
    ];
    let value = |(name, source, scatter, degrees, expected): (&str, _, Scatter, f64, f64)| {
        let name = format!("{name}: PSF at {degrees} degrees, sr^-1");
        Check::new(name, source, scatter.psf(degrees), expected, 1e-3 * expected)
    };
    let mut checks: Vec<Check> = values.into_iter().map(value).collect();
    for (pigmentation, expected) in [(0.0, 1.0050), (0.5, 1.0103), (1.0, 1.0154)] {
        let scatter = person(Psf::Cie, 30.0, pigmentation);
        let name = format!("CIE total, pigmentation {pigmentation}: integral over the hemisphere");
        checks.push(Check::new(name, cie, hemisphere(&scatter), expected, 1e-4));
    }
    checks
}

fn hemisphere(scatter: &Scatter) -> f64 {
    beyond(scatter, 1e-6)
}

/// Share of a point's light that is scattered by more than `from` degrees.
fn beyond(scatter: &Scatter, from: f64) -> f64 {
    let rings = 20_000;
    let step = (90.0 / from).ln() / f64::from(rings);
    let ring = |i: i32| {
        let t = from * (step * (f64::from(i) + 0.5)).exp();
        scatter.psf(t) * 2.0 * PI * t.to_radians().sin() * t.to_radians() * step
    };
    (0..rings).map(ring).sum()
}

/// Radius of the sun, degrees.
const RADIUS: f64 = 0.2665;

/// A uniform disc of 0.533 degrees in a dark picture: its veil, and the sum of the picture.
fn disc() -> Result<Vec<Check>> {
    let (width, height) = (481, 271);
    let degrees = 8.0 / width as f64;
    let part = |i: usize| ((i as f64 + 0.5) / 8.0 - 0.5) * degrees;
    let light = |i: usize| {
        let [x, y] = [i % width, i / width].map(|v| v as f64 * degrees);
        let [x, y] = [x - 240.0 * degrees, y - 135.0 * degrees];
        let inside = |k: &usize| (x + part(k % 8)).hypot(y + part(k / 8)) < RADIUS;
        (0..64).filter(inside).count() as f32 / 64.0
    };
    let samples = Samples::Float((0..width * height).map(light).collect());
    let s = Planes { width, height, count: 1, samples };
    let scatter = person(Psf::Cie, 30.0, 0.5);
    let optics = Optics::new(&scatter, [width, height], degrees, 1, 3e-3).map_err(Error::light)?;
    let mut r = s.clone();
    optics.into_iter().for_each(|mut optics| optics.exchange(&s, None, &mut r));
    let source = "integral of the CIE equation over the disc";
    let veil = |(t, expected): (f64, f64)| {
        let x = 240.0 + t / degrees;
        let at = |x: f64| r.at(x as usize, 135, 0).ln();
        let found = (at(x) * (1.0 - x.fract()) + at(x + 1.0) * x.fract()).exp();
        let name = format!("veil {t} degrees from the middle of a disc of 0.533 degrees");
        Check::new(name, source, found, expected, 3e-3 * expected)
    };
    let mut checks: Vec<Check> =
        [(0.5, 1.2705e-2), (1.0, 1.3853e-3), (2.0, 2.0097e-4), (3.0, 7.0059e-5)].map(veil).into();
    let sum =
        |planes: &Planes| (0..width * height).map(|i| planes.at(i % width, i / width, 0)).sum();
    let (before, after): (f64, f64) = (sum(&s), sum(&r));
    let name = "light of a picture after scatter over that before";
    checks.push(Check::new(name, "K is symmetric", after / before, 1.0, 1e-6));
    Ok(checks)
}

/// L pigment in the low sun's disc after a second through a pupil of 3 mm, by all of its light and
/// by what scatter leaves there.
fn bleached_disc() -> [Check; 2] {
    // td: 6.7e5 cd/m2 of the sun half a degree up, as L cones see it.
    let light = 5.581e6;
    let kept = 1.0 - beyond(&person(Psf::Cie, 30.0, 0.5), RADIUS);
    let pigment = Kinetics::standard()[0];
    let p = |share: f64| advance(&pigment, 1.0, Trolands(share * light), Seconds(1.0), 1);
    [(1.0, "its light", 0.0996), (kept, "its light that is not scattered out", 0.1447)].map(
        |(share, words, expected)| {
            let name = format!("unbleached L in the disc after 1 s of {words}");
            Check::new(name, "small model of the veil", p(share), expected, 2e-3)
        },
    )
}

/// L pigment beside the low sun after 30 s through a pupil of 3 mm, with and without scatter. The
/// expected numbers are of a small model of a sky and a uniform disc: the scene's disc is darker at
/// its limb, and its sky exchanges light with itself.
fn pigment(subject: &Subject) -> Result<Vec<Check>> {
    let mut checks = Vec::new();
    for (psf, expected, tolerance) in [
        ("none", [(0.5, 0.802), (1.0, 0.849), (2.0, 0.899)], 1e-2),
        ("cie", [(0.5, 0.384), (1.0, 0.780), (2.0, 0.888)], 2e-2),
    ] {
        let config = subject.config(&format!(
            "observer = {{ pupil = \"fixed\", pupil_mm = 3, stiles_crawford = \"off\", field_deg = 10, \
             optical_density = [0.38, 0.38, 0.30] }}\noptics.psf = {psf:?}\nnumerics.model = \"tracked\""
        ))?;
        let scene = Scene::open(&config)?;
        let loaded = scene.sequence(Some(Vec::new())).load(0, None)?;
        let planes = &loaded.frame.planes;
        let gaze = [(planes.width - 1) as f64 / 2.0, (planes.height - 1) as f64 / 2.0];
        let mut eye = scene.eye(&config)?;
        let survey = &loaded.survey;
        let stimulus = Stimulus::new(planes, survey);
        let look = eye.look_at(stimulus, gaze, Seconds(30.0));
        for (degrees, expected) in expected {
            let x = (gaze[0] + degrees * planes.width as f64 / FIELD_DEG).round() as usize;
            let p = eye.fractions_at(&look, [x, planes.height / 2])[0];
            let name = format!("psf {psf}: unbleached L {degrees} degrees from the low sun, 30 s");
            // Half a degree off, the veil is that of the disc's rim, which the scene darkens.
            checks.push(match (psf, degrees) {
                ("cie", 0.5) => Check::info(name, "uniform disc; ours has a limb", p, expected),
                _ => Check::new(name, "small model of the veil", p, expected, tolerance),
            });
        }
    }
    Ok(checks)
}
