//! The optics stage: light that the eye scatters, where it does. Off, it is not there.

use std::sync::{Arc, OnceLock};

use serde_json::{Value, json};

use super::adapting::Surveyor;
use super::beyond::Grid;
use super::{Eye, Stimulus, Surround};
use crate::light::{Planes, Row, Samples, Survey};
use crate::optics::{Draw, Extent, Optics, VeilAround};
use crate::units::{Millimetres, Nits};

/// The optics, and the frame that it did last.
pub(super) struct OpticsStage {
    optics: Optics,
    draw: Draw,
    /// Luminance around the picture, where it was given.
    beyond: Option<Nits>,
    /// The light on the retina.
    retinal: Planes,
    /// The survey of the frame: each frame has one of its own.
    of: Option<Arc<Survey>>,
    /// The survey of the light that is seen.
    seen: Option<Arc<Survey>>,
    /// The light beyond the picture, unless the gaze is held.
    around: Option<VeiledAround>,
}

/// The light beyond the picture, cell by cell.
struct VeiledAround {
    canvas: Option<VeilAround>,
    planes: Planes,
    td: Grid<f32>,
}

impl OpticsStage {
    pub(super) fn new(optics: Optics, draw: Draw) -> OpticsStage {
        let [retinal, planes] = [(); 2].map(|()| Planes::float(0, 0, 0));
        let td = Grid::alike(optics.extent_around(), [0.0; 3]);
        let around = Some(VeiledAround { canvas: None, planes, td });
        OpticsStage { optics, draw, beyond: None, retinal, of: None, seen: None, around }
    }

    /// The same in a world that is known.
    pub(super) fn within(self, surround: Surround) -> OpticsStage {
        OpticsStage { beyond: surround.known(), ..self }
    }

    /// Where the cells beyond the picture lie.
    pub(super) fn extent(&self) -> Extent {
        self.optics.extent_around()
    }

    /// Spares the light beyond the picture, which a gaze that is held never meets.
    pub(super) fn hold_gaze(&mut self) {
        self.around = None;
    }

    /// Makes the cone illuminance beyond the picture, by the weight of each plane.
    pub(super) fn illuminate_around(&mut self, weights: &[Vec<f64>; 3]) {
        let Some(VeiledAround { planes, td, .. }) = &mut self.around else { return };
        let Samples::Float(light) = &planes.samples else { return };
        let (width, count) = (planes.width, planes.count);
        for (row, light) in td.rows_mut().zip(light.chunks_exact(count * width)) {
            for (td, weights) in row.chunks_exact_mut(width).zip(weights) {
                for (x, td) in td.iter_mut().enumerate() {
                    let planes = weights.iter().enumerate();
                    let sum = planes.map(|(i, w)| w * f64::from(light[i * width + x]));
                    *td = sum.sum::<f64>().max(0.0) as f32;
                }
            }
        }
    }

    /// Cone illuminance beyond the picture, td, once a frame was done.
    pub(super) fn light_around(&self) -> Option<&Grid<f32>> {
        self.of.as_ref().and(self.around.as_ref()).map(|around| &around.td)
    }

    /// Makes the light on the retina, and the survey of it where it is what is seen.
    fn exchange(
        &mut self,
        s: &Planes,
        beyond: Option<&[f32]>,
        surveyor: impl FnOnce() -> Surveyor,
    ) -> Option<Arc<Survey>> {
        if self.draw == Draw::Clear {
            self.optics.exchange(s, beyond, &mut self.retinal);
            return None;
        }
        let (surveyor, rows) = (surveyor(), vec![const { OnceLock::new() }; s.height]);
        self.optics.exchange_met(s, beyond, &mut self.retinal, |y, row| {
            rows[y].get_or_init(|| surveyor.row(Row::Float(row)));
        });
        let rows = rows.into_iter().filter_map(OnceLock::into_inner);
        Some(Arc::new(surveyor.cells.gather(rows)))
    }

    /// The light on the retina.
    pub(super) fn retinal(&self) -> &Planes {
        &self.retinal
    }

    /// The light that is seen where it is not that on the retina.
    pub(super) fn shown<'a>(&self, planes: &'a Planes) -> Option<&'a Planes> {
        (self.draw == Draw::Clear).then_some(planes)
    }

    /// The share of its light that a place keeps.
    fn kept(&self, [x, y]: [usize; 2]) -> f64 {
        f64::from(self.optics.kept()[y * self.retinal.width + x])
    }

    /// What it can cost, for the report.
    pub(super) fn report(&self) -> Value {
        let (gaussians, levels) = self.optics.extent();
        let light = self.optics.bound();
        json!({
            "what": format!(
                "optics: at most {light:.1e} of the light, by {gaussians} Gaussians on a pyramid of {levels} levels"
            ),
            "bound_of_light": light,
            "moves_p": PER_LOG_LIGHT * light,
            "moves_catch": PER_CATCH * light,
            "draw": self.draw,
        })
    }
}

/// The greatest change of p for a change of ln I: 1/e, that of a step without regeneration.
const PER_LOG_LIGHT: f64 = 0.3679;

/// The greatest relative change of a catch for one of the light: its own, and what pigment that has
/// all but gone makes of it, 10.6 in the worst transient.
const PER_CATCH: f64 = 11.6;

impl Eye {
    /// Does a frame's scatter, unless it was the last frame too. `None`: there is none, or none that
    /// matters: a veil that is not drawn over pigment that does not bleach, or that of a field,
    /// which scatters itself.
    pub(super) fn scatter(&mut self, s: Stimulus<'_>, bleaches: bool) -> Option<OpticsStage> {
        if self.optics.is_none() || self.uniform.is_some() {
            return None;
        }
        let beyond = self.light_beyond();
        let free = self.optics.as_ref()?.around.is_some();
        let around = free.then(|| self.equal_energy(self.surround_luminance()));
        let stage = self.optics.as_mut()?;
        if !bleaches && stage.draw == Draw::Clear {
            stage.of = None;
            return None;
        }
        if !stage.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, s.survey)) {
            stage.seen = stage.exchange(s.planes, beyond.as_deref(), || {
                Surveyor::new(&self.vision, s.planes, self.pixels_per_degree)
            });
            if let Some((VeiledAround { canvas, planes, .. }, light)) =
                stage.around.as_mut().zip(around)
            {
                stage.optics.veil_around(&light, canvas, planes);
            }
            stage.of = Some(s.survey.clone());
        }
        self.optics.take()
    }

    /// The light around the picture, plane by plane, where a luminance was given. The picture's edge
    /// says little of its colour: then no light leaves the picture or comes in.
    fn light_beyond(&self) -> Option<Vec<f32>> {
        self.optics.as_ref()?.beyond.map(|nits| self.equal_energy(nits))
    }

    /// An equal-energy light, plane by plane.
    fn equal_energy(&self, luminance: Nits) -> Vec<f32> {
        let planes = self.vision.equal_energy_planes();
        planes.into_iter().map(|v| (v * luminance.0) as f32).collect()
    }

    /// Weights of each plane in the cone illuminance of a place far from the gaze, td.
    pub(super) fn weights_around(&self, pupil: Millimetres) -> [Vec<f64>; 3] {
        let of_levels = self.vision.illuminance_weights(pupil, Millimetres(f64::INFINITY));
        let count = self.vision.plane_count();
        let of_plane = |plane: usize| {
            let rows = 0..self.vision.moment_count();
            let moments: Vec<f64> = rows.map(|row| self.vision.moment_weight(row, plane)).collect();
            self.vision.illuminance(&moments, &of_levels)
        };
        let of_planes: Vec<[f64; 3]> = (0..count).map(of_plane).collect();
        [0, 1, 2].map(|k| of_planes.iter().map(|weights| weights[k]).collect())
    }

    /// The light on the retina of a frame that was looked at.
    pub(crate) fn on_the_retina<'a>(&'a self, planes: &'a Planes) -> &'a Planes {
        self.optics.as_ref().filter(|stage| stage.of.is_some()).map_or(planes, |s| &s.retinal)
    }

    /// The share of its light that a place kept, and the projections of the light that others and it
    /// itself sent there, in a frame that was looked at.
    pub(super) fn veil(&self, planes: &Planes, at @ [x, y]: [usize; 2]) -> Option<(f64, Vec<f64>)> {
        let stage = self.optics.as_ref().filter(|stage| stage.of.is_some())?;
        let kept = stage.kept(at);
        let of = |planes| self.vision.moments(planes, x, y);
        let veil = of(&stage.retinal).into_iter().zip(of(planes)).map(|(r, s)| r - kept * s);
        Some((kept, veil.collect()))
    }

    /// The light that was seen, through what pigment was left, of a frame that was looked at.
    pub(crate) fn seen_light<'a>(&'a self, planes: &'a Planes) -> &'a Planes {
        let clear = self.optics.as_ref().is_some_and(|stage| stage.draw == Draw::Clear);
        if clear { planes } else { self.on_the_retina(planes) }
    }
}

impl Stimulus<'_> {
    /// The survey of what is seen of it.
    pub(super) fn seen_survey(&self, stage: Option<&OpticsStage>) -> Arc<Survey> {
        stage.and_then(|stage| stage.seen.clone()).unwrap_or_else(|| self.survey.clone())
    }
}
