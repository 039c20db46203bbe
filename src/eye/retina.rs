//! The retina: the unbleached fraction of three pigments at every place, moved by light.
//!
//! Places are counted in pixels of the picture at the first gaze. When the gaze has moved by
//! `shift` pixels, the place r sees the picture at r + shift. **Light is resampled to the places, p
//! is read at the picture's points; the state itself is never resampled**, which would blur it by
//! sqrt(n f (1 - f)) pixels after n frames. Places that no picture has covered yet have all seen
//! the same surround; they are kept as one, and become places of their own when the gaze first
//! brings the picture to them.

use ndarray::{Array3, Axis, s};
use rayon::prelude::*;

use crate::kernel::{self, FirstOrderForm};
use crate::kinetics::{Kinetics, Law};
use crate::step::{self, Enclosed, Method};
use crate::units::{Seconds, Trolands};

/// How pigment follows light.
#[derive(Clone, Copy)]
pub enum Model {
    /// It does not: the eye stays as it started.
    Unbleached,
    /// At once (paper Eq. 1, frame by frame).
    Steady,
    /// By a method of the table. `substeps` 0: as many as keep the relative error of the
    /// whole run within `budget`.
    Tracked { method: &'static Method, substeps: u32, budget: f64 },
}

impl Model {
    /// What to say if a step takes the method past its limit under the greatest cone illuminances,
    /// td.
    pub fn past_limit(
        &self,
        pigments: &[Kinetics; 3],
        greatest: [f64; 3],
        dt: Seconds,
    ) -> Option<String> {
        let Model::Tracked { method, substeps, .. } = self else { return None };
        let past = pigments
            .iter()
            .zip(greatest)
            .filter_map(|(pigment, td)| method.past_limit(pigment, Trolands(td), dt, *substeps));
        let worst = past.max_by(|a, b| a.h_lambda.total_cmp(&b.h_lambda))?;
        Some(format!("{worst} of method {:?}: its pigment is not to be trusted", method.name))
    }

    /// The name in `trace.csv` and `report.json`.
    pub fn name(&self) -> &'static str {
        match self {
            Model::Unbleached => "none",
            Model::Steady => "steady",
            Model::Tracked { .. } => "tracked",
        }
    }
}

/// One step of the pigments, the same at every place but for the light.
#[derive(Clone, Copy)]
pub struct Advance {
    pub pigments: [Kinetics; 3],
    pub model: Model,
    pub duration: Seconds,
    forms: [FirstOrderForm; 3],
}

impl Advance {
    /// A step of some length by a model.
    pub fn new(pigments: [Kinetics; 3], model: Model, duration: Seconds) -> Self {
        let forms = pigments.each_ref().map(|pigment| FirstOrderForm::new(pigment, duration));
        Advance { pigments, model, duration, forms }
    }

    /// Moves rows of L, M, S pigment by rows of L, M, S light, td.
    pub fn row(&self, light: &[f32], p: &mut [f64]) {
        let width = p.len() / 3;
        for (cone, (p, light)) in
            p.chunks_exact_mut(width).zip(light.chunks_exact(width)).enumerate()
        {
            self.cone(cone, self.model, light, p);
        }
    }

    /// Moves a run of one cone class's pigment by a run of its light, td, by a model of its own.
    /// Returns the least of it.
    pub fn cone(&self, cone: usize, model: Model, light: &[f32], p: &mut [f64]) -> f64 {
        let pigment = &self.pigments[cone];
        match model {
            Model::Unbleached => {}
            Model::Steady if pigment.law == Law::FirstOrder => {
                kernel::steady(self.forms[cone], light, p);
            }
            Model::Tracked { method, .. }
                if pigment.law == Law::FirstOrder && method.name == "exact" =>
            {
                return kernel::relax(self.forms[cone], light, p);
            }
            _ => p
                .iter_mut()
                .zip(light)
                .for_each(|(p, &td)| *p = self.place(model, pigment, *p, f64::from(td))),
        }
        kernel::least(p)
    }

    /// Moves one pigment at one place: the scalar path of every law and method.
    pub fn place(&self, model: Model, pigment: &Kinetics, p: f64, td: f64) -> f64 {
        let light = Trolands(td);
        match model {
            Model::Unbleached => p,
            Model::Steady => pigment.steady(light),
            Model::Tracked { method, substeps: 0, budget } if method.name == "exact" => {
                self.exact(budget, pigment, p, light)
            }
            Model::Tracked { method, substeps, .. } => {
                method.hold(pigment, p, light, self.duration, substeps.max(1))
            }
        }
    }
}

impl Advance {
    /// The exact step of any law, within `budget` where as many sub-steps as are tried can keep it.
    pub fn exact(&self, budget: f64, pigment: &Kinetics, p: f64, light: Trolands) -> f64 {
        let most = || step::enclosed(pigment, p, light, self.duration, step::MOST_SUBSTEPS);
        self.within(budget, pigment, p, light).unwrap_or_else(most).p
    }

    /// The exact step of any law, its sub-steps as many as keep the relative error of p, over the
    /// whole run, within `budget`; `None` if that are more than are tried.
    ///
    /// With u = ln 1/p1 and k what the step forgets the least of, a step may err by `budget`/2 (1 -
    /// k) p1/(1 + u)^2. Then the relative error stays below `budget`/2 (2 - 1/(1 + u)), whatever
    /// the steps and the light: what p loses by bleaching the integral of 1/(1 + u)^2 takes up,
    /// what it does not lose is forgotten. Self-screened pigment bleaches faster than its error by
    /// a `growth` that the budget is divided by.
    fn within(&self, budget: f64, pigment: &Kinetics, p: f64, light: Trolands) -> Option<Enclosed> {
        let forgets = -(-self.duration.0 * pigment.contraction(light)[0]).exp_m1();
        let share = 0.5 * budget / pigment.growth() * forgets;
        let doubled = (0..)
            .map(|doublings| 1 << doublings)
            .take_while(|&substeps| substeps <= step::MOST_SUBSTEPS);
        let mut found =
            doubled.map(|substeps| step::enclosed(pigment, p, light, self.duration, substeps));
        found.find(|found| found.error <= share * found.p / (1.0 - found.p.ln()).powi(2))
    }
}

/// The least budget of a law without a closed form that `MOST_SUBSTEPS` sub-steps are known to
/// keep, whatever the light and the step.
pub const LEAST_KEPT: f64 = 2.5e-5;

/// Pigment at every place. Rows of three runs, L, M and S: shape (height, 3, width).
#[derive(Clone, Debug, PartialEq)]
pub struct Retina {
    p: Array3<f64>,
    /// The first column and row that are kept, in places.
    origin: [i64; 2],
    /// Pigment wherever no picture has been.
    beyond: [f64; 3],
}

impl Retina {
    /// Every pigment unbleached.
    pub fn rested(width: usize, height: usize) -> Self {
        Retina { p: Array3::ones((height, 3, width)), origin: [0, 0], beyond: [1.0; 3] }
    }

    /// A retina of given fractions, shape (height, 3, width), in standard layout; values outside
    /// 0..1 are limited.
    pub fn from_fractions(p: Array3<f64>, beyond: [f64; 3]) -> Self {
        let p = p.as_standard_layout().mapv(|v| v.clamp(0.0, 1.0));
        Retina { p, origin: [0, 0], beyond }
    }

    /// Columns and rows that are kept.
    pub fn size(&self) -> [usize; 2] {
        [self.p.len_of(Axis(2)), self.p.len_of(Axis(0))]
    }

    /// The first column and row that are kept.
    pub fn origin(&self) -> [i64; 2] {
        self.origin
    }

    /// Pigment wherever no picture has been.
    pub fn beyond(&self) -> [f64; 3] {
        self.beyond
    }

    /// Everything that is kept: rows of L, M, S.
    pub fn fractions(&self) -> &[f64] {
        self.p.as_slice().unwrap_or(&[])
    }

    /// Takes up what [`Retina::fractions`], `size`, `origin` and `beyond` gave; `None` if they do
    /// not fit together.
    pub fn restored(
        p: Vec<f64>,
        [width, height]: [usize; 2],
        origin: [i64; 2],
        beyond: [f64; 3],
    ) -> Option<Self> {
        Some(Retina { p: Array3::from_shape_vec((height, 3, width), p).ok()?, origin, beyond })
    }

    /// The picture's places at the first gaze: rows of L, M, S.
    pub fn first_view(&self, width: usize, height: usize) -> Array3<f64> {
        let [x, y] = self.origin.map(|o| (-o).max(0) as usize);
        self.p.slice(s![y..y + height, .., x..x + width]).to_owned()
    }

    /// Mutable rows, each three runs.
    pub fn rows_mut(&mut self) -> std::slice::ChunksExactMut<'_, f64> {
        let per_row = 3 * self.size()[0];
        self.p.as_slice_mut().unwrap_or(&mut []).chunks_exact_mut(per_row)
    }

    /// Mutable rows for parallel work, each three runs.
    pub fn par_rows_mut(&mut self) -> rayon::slice::ChunksExactMut<'_, f64> {
        let per_row = 3 * self.size()[0];
        self.p.as_slice_mut().unwrap_or(&mut []).par_chunks_exact_mut(per_row)
    }

    /// Fractions at one place of the kept ones.
    pub fn at(&self, place: [i64; 2]) -> [f64; 3] {
        let [x, y] = [0, 1].map(|i| place[i] - self.origin[i]);
        let [width, height] = self.size();
        if x < 0 || y < 0 || x >= width as i64 || y >= height as i64 {
            return self.beyond;
        }
        [0, 1, 2].map(|k| self.p[[y as usize, k, x as usize]])
    }

    /// Makes places of their own of all that lie in the rectangle `from..=to`; they have seen only
    /// the surround. Columns are added on the left by whole tiles of `tile` places, so that none is
    /// cut anew. Returns how many tiles and rows were added before the old ones.
    pub fn cover(&mut self, from: [i64; 2], to: [i64; 2], tile: usize) -> [usize; 2] {
        let [width, height] = self.size();
        let last = [self.origin[0] + width as i64 - 1, self.origin[1] + height as i64 - 1];
        let missing = [0, 1].map(|i| (self.origin[i] - from[i]).max(0) as usize);
        let [tiles, y] = [missing[0].div_ceil(tile), missing[1]];
        let x = tiles * tile;
        let first = [self.origin[0] - x as i64, self.origin[1] - y as i64];
        let end = [0, 1].map(|i| to[i].max(last[i]));
        if first != self.origin || end != last {
            let [w, h] = [0, 1].map(|i| (end[i] - first[i] + 1) as usize);
            let mut grown = Array3::from_shape_fn((h, 3, w), |(_, k, _)| self.beyond[k]);
            grown.slice_mut(s![y..y + height, .., x..x + width]).assign(&self.p);
            (self.p, self.origin) = (grown, first);
        }
        [tiles, y]
    }

    /// Moves the places that no picture has covered by the surround's light, td.
    pub fn advance_beyond(&mut self, advance: &Advance, surround: [f64; 3]) {
        let light = surround.map(|td| td as f32);
        advance.row(&light, &mut self.beyond);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_join_the_retina_have_seen_only_the_surround() {
        let pigments = [Kinetics::first_order(Trolands(2e4), Seconds(120.0)); 3];
        let Some(method) = Method::named("exact") else { panic!("exact is in the table") };
        let model = Model::Tracked { method, substeps: 0, budget: 1e-3 };
        let advance = Advance::new(pigments, model, Seconds(10.0));
        let mut retina = Retina::rested(2, 1);
        retina.rows_mut().for_each(|row| advance.row(&[1e6; 6], row));
        retina.advance_beyond(&advance, [1e4; 3]);
        let (inside, outside) = (retina.at([1, 0]), retina.beyond());
        assert_eq!(retina.cover([-1, 0], [1, 2], 4), [1, 0]);
        assert_eq!(retina.size(), [6, 3]);
        assert_eq!(retina.at([1, 0]), inside);
        assert_eq!(retina.at([-1, 2]), outside);
        assert!(inside[0] < outside[0] && outside[0] < 1.0);
    }

    #[test]
    fn no_light_and_no_step_asks_for_more_substeps_than_are_tried() {
        let laws = [
            Law::self_screened(0.3),
            Law::self_screened(0.5),
            Law::RateLimited { km: 0.05 },
            Law::RateLimited { km: 0.2 },
        ];
        let grid = |from: i32, to: i32| (from..=to).map(|log| 10f64.powf(f64::from(log) / 4.0));
        for law in laws {
            let pigment = Kinetics { law, half_bleach: Trolands(2e4), tau: Seconds(120.0) };
            for (td, dt) in grid(-4, 44).flat_map(|td| grid(-12, 16).map(move |dt| (td, dt))) {
                let advance = Advance::new([pigment; 3], Model::Steady, Seconds(dt));
                for p in [1.0, 0.9, 0.3, 1e-2, 1e-4, 1e-8] {
                    let found = advance.within(LEAST_KEPT, &pigment, p, Trolands(td));
                    assert!(found.is_some(), "{law:?}: {td} td for {dt} s from {p}");
                }
            }
        }
    }
}
