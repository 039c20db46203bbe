//! The observer: what light means to one place on the retina. Knows nothing of time, pictures or
//! files.

pub mod directional;
pub mod fundamentals;
pub mod pupil;

use crate::colour::Matrix;
use crate::spectrum::Curve;
use crate::units::{Degrees, LUMENS_PER_WATT, Millimetres, Trolands};

pub use directional::{Directional, Reading, Steepness};
pub use fundamentals::{CONES, Field, Fundamentals, Set};
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
        let lms_to_xyz = set.lms_to_xyz(field);
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
            cone_troland: areas.map(|area| v / area),
        }
    }

    /// The standard observer: CIE 2006, 10 degrees, 30 years, two eyes, Stiles-Crawford over the
    /// pupil.
    pub fn standard() -> Self {
        let (set, field) = (Set::Cie2006, Field::TenDegrees);
        let directional = Directional::new(Reading::Pupil, Steepness::Measured);
        Observer::new(set, field, set.optical_density(field), Narrowing::Depleted, directional)
    }

    /// c_k: makes an equal-energy light of 1 td give 1 in every class.
    pub fn cone_troland(&self) -> [f64; 3] {
        self.cone_troland
    }

    /// This observer's luminous efficiency: the Y row of LMS -> XYZ. 10.9 % above CIE 1931 for
    /// equal energy.
    pub fn luminous_efficiency(&self) -> Curve {
        let y = self.lms_to_xyz[1];
        let [l, m, s] = [0, 1, 2].map(|k| self.fundamentals.unbleached(k));
        Curve((0..l.0.len()).map(|i| y[0] * l.0[i] + y[1] * m.0[i] + y[2] * s.0[i]).collect())
    }

    /// Cone illuminance of a spectral radiance known at every nm, from the definition, without
    /// levels or bands: I_k = 683 c_k A integral L eta s_k (paper Eq. 2, 6, 7). `r`: distance from
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
            Trolands(LUMENS_PER_WATT * self.cone_troland[k] * pupil::area(pupil) * integral)
        })
    }

    /// Catches of a spectral radiance known at every nm through pigments at `p`, from the
    /// definition; in units whose Y row gives cd/m2.
    pub fn catch(&self, radiance: &Curve, p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| {
            let depleted = radiance.times(&self.fundamentals.depleted(k, p[k])).integral();
            LUMENS_PER_WATT * depleted / self.own_peak(k, p[k])
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
        let luminance = LUMENS_PER_WATT * eye.luminous_efficiency().integral();
        let td = luminance * pupil::area(pupil);
        for cone in eye.illuminance(&flat, pupil, Millimetres(0.0)) {
            assert!((cone.0 / td - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn the_observers_luminance_of_equal_energy_is_a_tenth_above_1931() {
        let ours = Observer::standard().luminous_efficiency().integral();
        let y: f64 = crate::spectrum::CIE1931.column("y").iter().sum();
        assert!((ours / y - 1.109).abs() < 5e-4, "{}", ours / y);
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
