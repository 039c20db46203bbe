//! The observer: what light means to one place on the retina. Knows nothing of time, pictures or
//! files.

pub mod directional;
pub mod fundamentals;
pub mod photometry;
pub mod pupil;

use crate::colour::Matrix;
use crate::spectrum::Curve;
use crate::units::{Degrees, Millimetres, Trolands};

pub use directional::{Directional, Reading, Steepness};
pub use fundamentals::{CONES, Field, Fundamentals, Set};
pub use photometry::Photometry;
pub use pupil::{Adapting, Dynamics, Pupil, Rule};

/// What "narrowing the fundamentals by the bleaching percentage" means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    pub fundamentals: Fundamentals,
    pub lms_to_xyz: Matrix,
    pub narrowing: Narrowing,
    pub directional: Directional,
    pub pupil: Rule,
    pub dynamics: Dynamics,
    pub fovea: Degrees,
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
            pupil: Rule::WatsonYellott { age: 30.0, eyes: 2 },
            dynamics: Dynamics::default(),
            fovea: Degrees(2.0),
            lumens_per_watt,
            cone_troland: areas.map(|area| v / area),
        }
    }

    /// The standard observer: CIE 2006, 2 degrees (what is stared at is foveal, and cd/m2 is a unit
    /// of 2 degrees), 30 years, two eyes, Stiles-Crawford over the
    /// pupil.
    pub fn standard() -> Self {
        let (set, field) = (Set::Cie2006, Field::TwoDegrees);
        let directional = Directional::new(Reading::Pupil, Steepness::Measured);
        Observer::new(set, field, set.optical_density(field), Narrowing::Depleted, directional)
    }

    /// c_k: makes an equal-energy light of 1 td give 1 in every class.
    pub fn cone_troland(&self) -> [f64; 3] {
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
    pub fn own_peak(&self, cone: usize, p: f64) -> f64 {
        match self.narrowing {
            Narrowing::Depleted => 1.0,
            Narrowing::Narrowed if p == 0.0 => f64::MIN_POSITIVE,
            Narrowing::Narrowed => p * self.fundamentals.peak_per_pigment(cone, p),
        }
    }

    /// eta of an equal-energy light in each class, at `r` from the pupil's centre.
    pub fn equal_energy_weight(&self, pupil: Millimetres, r: Millimetres) -> [f64; 3] {
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
    fn equal_energy_and_lamps_read_what_a_photometer_reads_but_for_the_observers() {
        // Own luminance over that of CIE 1931: equal energy and a 2900 K lamp, 2 degrees.
        let observer = Observer::standard();
        let planck = |nm: f64| 1.0 / (nm.powi(5) * ((1.438_776_9e7 / (nm * 2900.0)).exp() - 1.0));
        let read = |light: Curve| {
            let own = light.times(&observer.luminous_efficiency()).integral();
            let y = Curve::sampled(|nm| crate::spectrum::CIE1931.interpolated("y", nm));
            let told = crate::units::LUMENS_PER_WATT * light.times(&y).integral();
            observer.lumens_per_watt * own / told
        };
        assert!((read(Curve::sampled(|_| 1.0)) - 1.0007).abs() < 2e-4);
        assert!((read(Curve::sampled(planck)) - 0.996).abs() < 1e-3);
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
}
