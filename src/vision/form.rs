//! Catches and percept of a vision in the shape that loops over rows want.

use super::{LEVELS, Vision};
use crate::kernel::{CatchForm, PerceptForm, PlanesForm};

impl Vision {
    /// The catches' loop.
    pub(crate) fn catch_form(&self) -> CatchForm {
        let single = |powers: [f64; 4]| powers.map(|c| c as f32);
        let peaks = match &self.peaks {
            None => [const { Vec::new() }; 3],
            Some(peaks) => peaks.each_ref().map(|peaks| {
                peaks.iter().map(|&values| single(self.levels.polynomial(values))).collect()
            }),
        };
        let weight = |k: usize, plane: usize| {
            let of_level = |j: usize| self.moment_weight(LEVELS.len() * k + j, plane);
            single(self.levels.polynomial([0, 1, 2].map(of_level)))
        };
        let planes = if self.returns_its_light() {
            PlanesForm::Rgb([0, 1, 2].map(|k| [0, 1, 2].map(|plane| weight(k, plane))))
        } else {
            let [outer, middle] =
                [self.levels.outer, self.levels.middle].map(|c| c.map(|c| c as f32));
            PlanesForm::Moments { outer, middle }
        };
        CatchForm { planes, peaks }
    }

    /// The percept's loop.
    pub(crate) fn percept_form(&self) -> PerceptForm {
        PerceptForm {
            lms_to_percept: self.lms_to_seen.map(|row| row.map(|v| v as f32)),
            returns_light: self.returns_its_light(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Primaries;
    use crate::kernel::{self, TILE};
    use crate::light::PlaneTile;
    use crate::light::{Planes, Samples};
    use crate::observer::{Narrowing, Observer};
    use crate::spectrum::Bands;
    use crate::units::Nits;

    const FRACTIONS: [[f64; 3]; 5] = [
        [0.9, 0.8, 0.7],
        [1e-6, 1e-5, 0.5],
        [1.0, 0.3, 1.0],
        [0.999_999, 1.0, 1.0],
        [1.0, 1.0, 1.0],
    ];

    fn seen(vision: &Vision, planes: &[f32], p: [f64; 3]) -> [f32; 3] {
        let light = PlaneTile::whole(planes, 1);
        let (mut in_single, mut lms, mut rgb) = ([[0.0; TILE]; 3], [[0.0]; 3], [[0.0]; 3]);
        kernel::single(p.each_ref().map(std::slice::from_ref), &mut in_single);
        let catches = lms.each_mut().map(|lms| &mut lms[..]);
        kernel::catch(&vision.catch_form(), light, &in_single, catches);
        let (lms, out) = (lms.each_ref().map(|lms| &lms[..]), rgb.each_mut().map(|v| &mut v[..]));
        kernel::percept(&vision.percept_form(), light, &in_single, lms, out);
        rgb.map(|[v]| v)
    }

    fn agrees(vision: &Vision, light: &[f32]) {
        let planes = Planes {
            width: 1,
            height: 1,
            count: light.len(),
            samples: Samples::Float(light.to_vec()),
        };
        let moments = vision.moments(&planes, 0, 0);
        for p in FRACTIONS {
            let ours = seen(vision, light, p);
            let exact = crate::colour::apply(&vision.lms_to_seen, vision.catch(&moments, p));
            let size = exact.iter().fold(0.0f64, |a, v| a.max(v.abs()));
            for (ours, exact) in ours.iter().zip(exact) {
                assert!(
                    (f64::from(*ours) - exact).abs() < 1e-5 * size,
                    "{p:?}: {ours:?} {exact:?}"
                );
            }
        }
    }

    fn narrowing_observer() -> Observer {
        let mut observer = Observer::standard();
        observer.narrowing = Narrowing::Narrowed;
        observer
    }

    #[test]
    fn the_run_agrees_with_the_scalar_percept_of_rgb() {
        for observer in [Observer::standard(), narrowing_observer()] {
            agrees(
                &Vision::of_rgb(observer, &Primaries::REC709, Nits(100.0)).unwrap(),
                &[0.7, 0.2, 0.05],
            );
        }
    }

    #[test]
    fn the_run_agrees_with_the_scalar_percept_of_bands() {
        let bands = Bands::uniform(395.0, 705.0, 31).unwrap();
        let light: Vec<f32> = (0..31).map(|i| 0.01 * (1.0 + (i as f32 * 0.4).sin())).collect();
        for observer in [Observer::standard(), narrowing_observer()] {
            let vision = Vision::of_bands(observer, &bands);
            let projection = vision.projection().unwrap();
            let mut moments = vec![0.0; projection.rows];
            projection.project(&light, &mut moments);
            agrees(&vision, &moments);
        }
    }

    #[test]
    fn an_unbleached_eye_returns_its_input_bit_for_bit() {
        let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, Nits(3.7)).unwrap();
        let light = [0.1f32, -3.3e-7, 6.5e4];
        assert_eq!(seen(&vision, &light, [1.0; 3]), light);
    }
}
