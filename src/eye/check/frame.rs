//! One frame at full model.

use super::worst;
use crate::kinetics::Kinetics;
use crate::light::Planes;
use crate::observer::pupil;
use crate::spectrum::Curve;
use crate::units::{Millimetres, Seconds};
use crate::vision::{SampledSpectra, Vision};

/// One frame as the check needs it.
pub(crate) struct CheckFrame<'a> {
    pub(crate) vision: &'a Vision,
    pub(crate) pigments: &'a [Kinetics; 3],
    /// What each place's spectrum was, band by band; RGB is read from the planes.
    pub(crate) kept: Option<&'a SampledSpectra>,
    /// The light on the retina.
    pub(crate) planes: &'a Planes,
    /// At a place whose spectrum is kept: the share of it that reaches the retina, and the
    /// projections of the light that the eye scatters there.
    pub(crate) veil: &'a dyn Fn([usize; 2]) -> Option<(f64, Vec<f64>)>,
    pub(crate) pupil: Millimetres,
    pub(crate) gaze: [f64; 2],
    /// How far the gaze has moved from the first, in pixels.
    pub(crate) shift: [f64; 2],
    /// Cone illuminance of a place around the picture, column and row, td.
    pub(crate) around: &'a dyn Fn([i64; 2]) -> [f64; 3],
    pub(crate) pixels_per_degree: f64,
    pub(crate) duration: Seconds,
}

impl CheckFrame<'_> {
    pub(super) fn light(&self, i: usize, [x, y]: [usize; 2]) -> Vec<f64> {
        match self.kept {
            Some(kept) => {
                let share = (self.veil)([x, y]).map_or(1.0, |(share, _)| share);
                kept.spectrum(i).into_iter().map(|v| share * v).collect()
            }
            None => (0..self.planes.count).map(|plane| self.planes.at(x, y, plane)).collect(),
        }
    }

    /// Cone illuminance of a pixel by the definition, td. `central`: the weights where the distance
    /// from the gaze does not matter.
    pub(super) fn illuminance(
        &self,
        light: &[f64],
        at: [usize; 2],
        central: &[Vec<f64>; 3],
    ) -> [f64; 3] {
        illuminance(self.distance(at).map(|r| self.weights(r)).as_ref().unwrap_or(central), light)
    }

    /// Cone illuminance with that of the light which the eye scatters to a place whose spectrum is
    /// kept: of its projections, for its spectrum is nowhere.
    pub(super) fn with_veil(&self, td: [f64; 3], at: [usize; 2]) -> [f64; 3] {
        let veil = self.kept.and_then(|_| (self.veil)(at));
        let r = Millimetres(self.distance(at).unwrap_or(0.0));
        let weights = || self.vision.illuminance_weights(self.pupil, r);
        let of_veil = veil.map(|(_, veil)| self.vision.illuminance(&veil, &weights()));
        of_veil.map_or(td, |of_veil| [0, 1, 2].map(|k| td[k] + of_veil[k]))
    }

    /// Cone illuminance of a place of the retina that sees between four pixels, td.
    pub(super) fn between(&self, place: [usize; 2], central: &[Vec<f64>; 3]) -> [f64; 3] {
        let at = [0, 1].map(|i| place[i] as f64 + self.shift[i]);
        let share = |t: f64, far: usize| if far == 1 { t } else { 1.0 - t };
        let mut sum = [0.0; 3];
        for [x, y] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let weight = share(at[0] - at[0].floor(), x) * share(at[1] - at[1].floor(), y);
            let td = self.of_pixel(
                [at[0].floor() as i64 + x as i64, at[1].floor() as i64 + y as i64],
                central,
            );
            sum = [0, 1, 2].map(|k| sum[k] + if weight > 0.0 { weight * td[k] } else { 0.0 });
        }
        sum
    }

    /// Cone illuminance of a pixel, or of what lies around the picture, td.
    fn of_pixel(&self, [x, y]: [i64; 2], central: &[Vec<f64>; 3]) -> [f64; 3] {
        if x < 0 || y < 0 || x >= self.planes.width as i64 || y >= self.planes.height as i64 {
            return (self.around)([x, y]);
        }
        let at = [x as usize, y as usize];
        if self.kept.is_some() {
            let moments = self.vision.moments(self.planes, at[0], at[1]);
            let r = Millimetres(self.distance(at).unwrap_or(0.0));
            return self
                .vision
                .illuminance(&moments, &self.vision.illuminance_weights(self.pupil, r));
        }
        let light: Vec<f64> =
            (0..self.planes.count).map(|plane| self.planes.at(at[0], at[1], plane)).collect();
        self.illuminance(&light, at, central)
    }

    /// Distance of a place from the pupil's centre, where the reading of the Stiles-Crawford weight
    /// asks for it.
    fn distance(&self, [x, y]: [usize; 2]) -> Option<f64> {
        let scale = self.vision.observer.directional.mm_per_degree()? / self.pixels_per_degree;
        Some(scale * (x as f64 - self.gaze[0]).hypot(y as f64 - self.gaze[1]))
    }

    /// Weights of each stored plane in each cone's illuminance, from the definition.
    pub(super) fn weights(&self, r: f64) -> [Vec<f64>; 3] {
        let observer = &self.vision.observer;
        let eta = observer.directional.exact(self.pupil, Millimetres(r));
        [0, 1, 2].map(|k| {
            let seen = eta.times(observer.fundamentals.unbleached(k));
            let scale =
                observer.lumens_per_watt * observer.cone_troland()[k] * pupil::area(self.pupil);
            self.vision.basis().iter().map(|light| scale * light.times(&seen).integral()).collect()
        })
    }

    /// The largest error of a catch: by levels at the run's p, against the definition at the true
    /// one, relative to what the light's parts catch, each taken as light.
    pub(super) fn error_of_catch(
        &self,
        light: &[f64],
        [x, y]: [usize; 2],
        ours: [f64; 3],
        p: [f64; 3],
    ) -> f64 {
        let (mut radiance, mut parts) = (Curve::sampled(|_| 0.0), Curve::sampled(|_| 0.0));
        for (value, basis) in light.iter().zip(self.vision.basis()) {
            radiance.0.iter_mut().zip(&basis.0).for_each(|(sum, b)| *sum += value * b);
            parts.0.iter_mut().zip(&basis.0).for_each(|(sum, b)| *sum += (value * b).abs());
        }
        let [exact, size] =
            [radiance, parts].map(|radiance| self.vision.observer.catch(&radiance, p));
        let veil = self.kept.and_then(|_| (self.veil)([x, y]));
        let veil = veil.map_or([0.0; 3], |(_, veil)| self.vision.catch(&veil, p));
        let exact = [0, 1, 2].map(|k| exact[k] + veil[k]);
        let size = [0, 1, 2].map(|k| size[k] + veil[k].abs());
        let seen = self.vision.catch(&self.vision.moments(self.planes, x, y), ours);
        (0..3)
            .filter(|&k| size[k] > 0.0)
            .map(|k| (seen[k] - exact[k]).abs() / size[k])
            .fold(0.0, worst)
    }
}

fn illuminance(weights: &[Vec<f64>; 3], light: &[f64]) -> [f64; 3] {
    weights
        .each_ref()
        .map(|weights| weights.iter().zip(light).map(|(w, v)| w * v).sum::<f64>().max(0.0))
}
