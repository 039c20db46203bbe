//! The observer: what light means to one place on the retina. Knows nothing of time, pictures or
//! files.

pub(crate) mod directional;
pub(crate) mod fundamentals;
pub(crate) mod lens;
pub(crate) mod photometry;
pub(crate) mod pupil;

use serde::{Deserialize, Serialize};

use crate::colour::Matrix;
use crate::spectrum::Curve;
use crate::units::{Degrees, Millimetres, Trolands};

pub use directional::{Directional, Reading, Steepness};
pub(crate) use fundamentals::{CONES, Fundamentals};
pub use fundamentals::{Field, Set};
pub(crate) use photometry::Photometry;
pub use pupil::{Adapting, Rule};
pub(crate) use pupil::{Dynamics, Pupil};

/// What "narrowing the fundamentals by the bleaching percentage" means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Narrowing {
    /// Divided by the unbleached peak: a bleached cone also catches less. This is what turns red to
    /// green.
    Depleted,
    /// Each divided by its own peak: the shape of the paper's Fig. 3, bottom.
    Narrowed,
}

/// Everything that differs between people, but for the speed of their pigments.
#[derive(Clone, Debug, PartialEq)]
pub struct Observer {
    pub(crate) fundamentals: Fundamentals,
    pub(crate) lms_to_xyz: Matrix,
    pub(crate) narrowing: Narrowing,
    pub directional: Directional,
    pub pupil: Rule,
    pub(crate) dynamics: Dynamics,
    pub(crate) fovea: Degrees,
    /// K, lm/W: radiance weighted by this observer's own V -> cd/m2.
    pub lumens_per_watt: f64,
    cone_troland: [f64; 3],
}

impl Observer {
    /// An observer with a published set of fundamentals at a field size and peak optical densities.
    pub fn new(
        set: Set,
        field: Field,
        density: [f64; 3],
        narrowing: Narrowing,
        directional: Directional,
    ) -> Self {
        let fundamentals = Fundamentals::new(set, field, density);
        let Photometry { lumens_per_watt, lms_to_xyz } =
            Photometry::new(&fundamentals, &set.lms_to_xyz(field));
        let areas = [0, 1, 2].map(|k| fundamentals.unbleached(k).integral());
        let v: f64 = lms_to_xyz[1].iter().zip(areas).map(|(m, area)| m * area).sum();
        Observer {
            fundamentals,
            lms_to_xyz,
            narrowing,
            directional,
            pupil: Rule::WatsonYellott { age: lens::TABULATED_AGE, eyes: 2 },
            dynamics: Dynamics::default(),
            fovea: Degrees(2.0),
            lumens_per_watt,
            cone_troland: areas.map(|area| v / area),
        }
    }

    /// The standard observer: CIE 2006, 2 degrees (what is stared at is foveal, and cd/m2 is a unit
    /// of 2 degrees), 32 years, two eyes, Stiles-Crawford over the pupil.
    pub fn standard() -> Self {
        let (set, field) = (Set::Cie2006, Field::TwoDegrees);
        let directional = Directional::new(Reading::Pupil, Steepness::Measured);
        Observer::new(set, field, set.optical_density(field), Narrowing::Depleted, directional)
    }

    /// The same person with the lens of an age, years ([`lens`]); from the tabulated observer.
    ///
    /// ```text
    /// s_k(A) = s_k T / t_k     t_k = max s_k T     T = 10^(D(32) - D(A))
    /// c_k(A) = t_k c_k         M_ik(A) = M_ik integral D65 s_k / integral D65 s_k(A)
    /// ```
    ///
    /// Trolands are counted before the lens, so an older retina gets less of them: c_k. The eye is
    /// used to its lens: D65 stays white, of the same luminance, so K is that of the tabulated
    /// observer.
    pub(crate) fn aged(self, age: f64) -> Self {
        let whites = |f: &Fundamentals| {
            let d65 = photometry::d65();
            [0, 1, 2].map(|k| d65.times(f.unbleached(k)).integral())
        };
        let before = whites(&self.fundamentals);
        let (fundamentals, passed) = self.fundamentals.behind(&lens::relative_transmittance(age));
        let after = whites(&fundamentals);
        Observer {
            lms_to_xyz: self
                .lms_to_xyz
                .map(|row| std::array::from_fn(|k| row[k] * (before[k] / after[k]))),
            cone_troland: std::array::from_fn(|k| self.cone_troland[k] * passed[k]),
            fundamentals,
            ..self
        }
    }

    /// c_k: makes an equal-energy light of 1 td give 1 in every class of the tabulated observer.
    pub(crate) fn cone_troland(&self) -> [f64; 3] {
        self.cone_troland
    }

    /// This observer's luminous efficiency V: the Y row of LMS -> XYZ.
    pub fn luminous_efficiency(&self) -> Curve {
        let y = self.lms_to_xyz[1];
        let [l, m, s] = [0, 1, 2].map(|k| self.fundamentals.unbleached(k));
        Curve((0..l.0.len()).map(|i| y[0] * l.0[i] + y[1] * m.0[i] + y[2] * s.0[i]).collect())
    }

    /// Cone illuminance of a spectral radiance known at every nm, from the definition, without
    /// levels or bands: I_k = K c_k A integral L eta s_k (paper Eq. 2, 6, 7). `r`: distance from
    /// the pupil's centre.
    pub fn illuminance(
        &self,
        radiance: &Curve,
        pupil: Millimetres,
        r: Millimetres,
    ) -> [Trolands; 3] {
        let weighted = radiance.times(&self.directional.exact(pupil, r));
        [0, 1, 2].map(|k| {
            let integral = weighted.times(self.fundamentals.unbleached(k)).integral();
            Trolands(self.lumens_per_watt * self.cone_troland[k] * pupil::area(pupil) * integral)
        })
    }

    /// Catches of a spectral radiance known at every nm through pigments at `p`, from the
    /// definition; in units whose Y row gives cd/m2.
    pub fn catch(&self, radiance: &Curve, p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let depleted = radiance.times(&self.fundamentals.depleted(k, p[k])).integral();
            self.lumens_per_watt * depleted / self.own_peak(k, p[k])
        })
    }

    /// What a catch is divided by for the narrowing: the peak of s_k(.; p), relative to that at p =
    /// 1, or 1.
    fn own_peak(&self, cone: usize, p: f64) -> f64 {
        match self.narrowing {
            Narrowing::Depleted => 1.0,
            Narrowing::Narrowed if p == 0.0 => f64::MIN_POSITIVE,
            Narrowing::Narrowed => p * self.fundamentals.peak_per_pigment(cone, p),
        }
    }

    /// eta of an equal-energy light in each class, at `r` from the pupil's centre.
    pub(crate) fn equal_energy_weight(&self, pupil: Millimetres, r: Millimetres) -> [f64; 3] {
        let eta = self.directional.exact(pupil, r);
        [0, 1, 2].map(|k| {
            let s = self.fundamentals.unbleached(k);
            s.times(&eta).integral() / s.integral()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_equal_energy_field_of_one_troland_is_one_cone_troland_in_each_class() {
        let mut eye = Observer::standard();
        eye.directional = Directional::new(Reading::Off, Steepness::Measured);
        let flat = Curve::sampled(|_| 1.0);
        let pupil = Millimetres(3.0);
        let luminance = eye.lumens_per_watt * eye.luminous_efficiency().integral();
        let td = luminance * pupil::area(pupil);
        for cone in eye.illuminance(&flat, pupil, Millimetres(0.0)) {
            assert!((cone.0 / td - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn each_narrowed_fundamental_keeps_its_peak_at_one() {
        let mut eye = Observer::standard();
        eye.narrowing = Narrowing::Narrowed;
        for cone in 0..3 {
            for p in [1.0, 0.5, 1e-3] {
                let own = eye.fundamentals.depleted(cone, p).peak() / eye.own_peak(cone, p);
                assert!((own - 1.0).abs() < 1e-12);
            }
        }
    }

    /// An orange lamp: 2900 K.
    fn lamp() -> Curve {
        Curve::sampled(|nm| 1e15 / (nm.powi(5) * ((1.438_776_9e7 / (nm * 2900.0)).exp() - 1.0)))
    }

    #[test]
    fn at_32_years_the_observer_is_the_tabulated_one_to_the_last_bit() {
        assert_eq!(Observer::standard().aged(lens::TABULATED_AGE), Observer::standard());
    }

    #[test]
    fn an_aged_retina_gets_what_the_tabulated_one_gets_behind_the_rest_of_the_lens() {
        let (young, pupil) = (Observer::standard(), Millimetres(3.0));
        for age in [20.0, 45.0, 60.0, 70.0, 80.0] {
            let old = young.clone().aged(age);
            for light in [lamp(), photometry::d65(), Curve::within(440.0, 450.0)] {
                let behind = light.times(&lens::relative_transmittance(age));
                let got = old.illuminance(&light, pupil, Millimetres(0.0));
                let expected = young.illuminance(&behind, pupil, Millimetres(0.0));
                for (got, expected) in got.into_iter().zip(expected) {
                    assert!((got.0 / expected.0 - 1.0).abs() < 1e-12, "{age}: {got:?}");
                }
            }
        }
    }

    #[test]
    fn at_every_age_d65_is_white_and_one_cd_per_m2_of_any_light_reads_one() {
        let young = Observer::standard();
        let white =
            crate::colour::apply(&young.lms_to_xyz, young.catch(&photometry::d65(), [1.0; 3]));
        for age in (20..=80).map(f64::from) {
            let old = young.clone().aged(age);
            assert!((0..3).all(|k| (old.fundamentals.unbleached(k).peak() - 1.0).abs() < 1e-12));
            let xyz =
                |light: &Curve| crate::colour::apply(&old.lms_to_xyz, old.catch(light, [1.0; 3]));
            for (own, of_32) in xyz(&photometry::d65()).into_iter().zip(white) {
                assert!((own / of_32 - 1.0).abs() < 1e-12, "{age}: {own} against {of_32}");
            }
            let unit = lamp().times(&old.luminous_efficiency()).integral() * old.lumens_per_watt;
            assert!((xyz(&lamp().scaled(1.0 / unit))[1] - 1.0).abs() < 1e-12, "{age}");
        }
    }

    #[test]
    fn an_older_eye_catches_less_blue_beside_red_and_bleached_catches_stay_finite() {
        let ages = (20..=80).step_by(4).map(f64::from);
        let mut last = f64::MAX;
        for old in ages.map(|age| Observer::standard().aged(age)) {
            let [blue, red] = [(400.0, 450.0), (650.0, 700.0)].map(|(from, to)| {
                old.illuminance(&Curve::within(from, to), Millimetres(3.0), Millimetres(0.0))
            });
            assert!(blue[0].0 / red[0].0 < last, "{blue:?} {red:?}");
            last = blue[0].0 / red[0].0;
            for p in [1.0, 0.5, 1e-6, 0.0] {
                assert!(old.catch(&lamp(), [p; 3]).iter().all(|v| v.is_finite() && *v >= 0.0));
            }
        }
    }
}
