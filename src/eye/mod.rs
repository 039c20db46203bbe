//! The eye: an observer and a retina in time. A look takes a frame's light to its percept.
//!
//! ```text
//! optics -> pupil -> illuminance -> pigment -> catch -> percept          stages.rs, in this order
//! ```
//!
//! Pixels are counted from the top left, their centres at integers: the middle of a picture is at
//! (width - 1)/2. A gaze is given in fractions of the picture ([`Gaze`]) or in pixels.

mod adapting;
mod beyond;
mod builder;
pub mod check;
mod context;
mod field;
mod illuminance;
mod moved;
mod percept;
pub mod pigment;
pub mod plan;
mod reading;
pub mod retina;
mod scattered;
mod stages;
mod state;
mod stats;
mod stimulus;

use std::sync::Arc;

use ndarray::{Array3, ArrayView3};

use crate::error::{Error, Result};
use crate::kinetics::Kinetics;
use crate::light::{Planes, Sample, Survey};
use crate::observer::{Observer, Pupil};
use crate::units::{Degrees, Millimetres, Nits, Seconds};
use crate::vision::Vision;

pub(crate) use adapting::brightest;
pub use adapting::survey;
pub use builder::EyeBuilder;
use check::Check;
use illuminance::IlluminanceOperator;
use percept::PerceptStage;
use pigment::Model;
use plan::Plan;
use retina::Retina;
use scattered::OpticsStage;
pub use state::State;
pub(crate) use stats::LookStats;
pub use stimulus::{Gaze, Light, Stimulus, Surround};

/// What one look found.
#[derive(Clone, Debug)]
pub struct Look {
    /// The percept: three planes in the light's own RGB and scale; half if the light was.
    pub percept: Planes,
    /// The percept's RGB -> linear sRGB in cd/m2, rows first.
    pub to_srgb: [[f32; 3]; 3],
    /// Luminances of the light that is seen: with its veil, where that is drawn.
    pub survey: Arc<Survey>,
    /// Where was looked, in pixels.
    pub(crate) gaze: [f64; 2],
    /// How far that is from the first gaze, in pixels.
    pub(crate) shift: [f64; 2],
    pub(crate) duration: Seconds,
    /// Mean luminance over the fovea.
    pub adapting: Nits,
    /// Diameter of the pupil.
    pub pupil: Millimetres,
    pub stats: LookStats,
}

impl Look {
    /// The percept as an array of shape (height, width, 3).
    pub fn to_array(&self) -> Array3<f32> {
        let Planes { width, height, .. } = self.percept;
        Array3::from_shape_fn((height, width, 3), |(y, x, i)| self.percept.at(x, y, i) as f32)
    }
}

/// An observer's eye that watches frames of one size.
pub struct Eye {
    vision: Vision,
    pigments: [Kinetics; 3],
    model: Model,
    size: [usize; 2],
    pixels_per_degree: f64,
    adapts_first: bool,
    // The state.
    retina: Retina,
    pupil: Pupil,
    plan: Plan,
    check: Option<Check>,
    first_gaze: Option<[f64; 2]>,
    surround: Surround,
    // The stages and their memory.
    optics: Option<OpticsStage>,
    percept: PerceptStage,
    illuminance: Option<IlluminanceOperator>,
    /// Moments of the light around the picture at 1 cd/m2.
    around: Vec<f64>,
    /// Cone illuminance of a whole picture, under a moved gaze.
    fields: Vec<f32>,
    /// The moments of the latest frame, if it was a uniform field.
    uniform: Option<Vec<f64>>,
    /// A percept to be written over, and the last frame that came as an array.
    spare: Option<Planes>,
    frame: Option<Planes>,
    /// Its bands, before they were projected.
    bands: Option<Planes>,
}

impl Eye {
    /// The standard observer's eye for frames of `size` (width, height) that are `across` degrees
    /// wide, modelled no more than a budget of 10^-3 of p and of a catch needs.
    ///
    /// # Errors
    /// The primaries span no gamut, or a size is zero.
    pub fn new(light: Light, size: [usize; 2], across: Degrees) -> Result<Eye> {
        Eye::builder(light.received_by(Observer::standard())?, size, across).build()
    }

    /// Promises that the gaze stays where it first goes: the veil beyond the picture, which only
    /// places meet that a gaze brings in later, is spared. If it moves all the same, the surround
    /// alone lies there. To be said before the first look.
    pub fn hold_gaze(&mut self) {
        self.optics.iter_mut().for_each(OpticsStage::hold_gaze);
        self.retina.forget_cells();
    }

    /// Looks at a frame for a while. `frame`: shape (height, width, planes), half or float, in the
    /// light's own order: R, G, B or bands.
    ///
    /// # Errors
    /// The shape is not that of the eye's frames, a sample is NaN or infinite, the gaze or the
    /// duration is not finite, or the duration is negative.
    pub fn look<T: Sample>(
        &mut self,
        frame: ArrayView3<'_, T>,
        gaze: Gaze,
        duration: Seconds,
    ) -> Result<Look> {
        if !(duration.0.is_finite() && duration.0 >= 0.0 && gaze.0.iter().all(|v| v.is_finite())) {
            return Err(Error::light("the gaze or the duration is not a finite number"));
        }
        let planes = self.taken_in(frame)?;
        let survey = Arc::new(survey(&self.vision, &planes, self.pixels_per_degree));
        let stimulus = Stimulus::new(&planes, &survey);
        let look = self.look_at(stimulus, gaze.pixel(self.size), duration);
        self.frame = Some(planes);
        Ok(look)
    }

    /// Looks at frames in turn: each with a gaze, in pixels, and a duration. `each` is shown every
    /// look, whose percept the next one writes over.
    pub(crate) fn watch<'a>(
        &mut self,
        frames: impl IntoIterator<Item = (Stimulus<'a>, [f64; 2], Seconds)>,
        mut each: impl FnMut(&Eye, &Look),
    ) {
        for (stimulus, gaze, duration) in frames {
            let look = self.look_at(stimulus, gaze, duration);
            each(self, &look);
            self.recycle(look.percept);
        }
    }

    /// The planes of a frame in memory, projected where it is of bands.
    fn taken_in<T: Sample>(&mut self, frame: ArrayView3<'_, T>) -> Result<Planes> {
        let [width, height] = self.size;
        let projection = self.vision.projection();
        let count = projection.map_or(self.vision.plane_count(), |projection| projection.bands);
        let expected = (height, width, count);
        if frame.dim() != expected {
            let problem = format!(
                "a frame has the shape {:?}; accepted: (height, width, planes) = {expected:?}",
                frame.dim()
            );
            return Err(Error::light(problem));
        }
        let room = if projection.is_some() { &mut self.bands } else { &mut self.frame };
        let given = Planes::of_frame(frame, room.take());
        if let Some([x, y, i]) = given.first_not_finite() {
            *room = Some(given);
            let problem = format!("plane {i} is not finite at column {x}, row {y}");
            return Err(Error::light(problem));
        }
        let Some(projection) = projection else { return Ok(given) };
        let moments = projection.of_frame(&given, self.frame.take());
        self.bands = Some(given);
        Ok(moments)
    }

    /// Gives a percept back to be written over by a later look.
    pub fn recycle(&mut self, percept: Planes) {
        self.spare = Some(percept);
    }

    /// Unbleached fractions at the picture's places at the first gaze: (height, width, 3).
    pub fn unbleached(&self) -> Array3<f64> {
        self.retina.first_view(self.size[0], self.size[1]).permuted_axes([0, 2, 1])
    }

    /// Cone illuminance of the frame of the latest [`Eye::look`], td: (height, width, 3). `None`
    /// before the first.
    pub fn trolands(&self) -> Option<Array3<f32>> {
        let (frame, operator) = (self.frame.as_ref()?, self.illuminance.as_ref()?);
        let mut td = Array3::zeros((frame.height, 3, frame.width));
        context::illuminate(self.on_the_retina(frame), operator, td.as_slice_mut()?);
        Some(td.permuted_axes([0, 2, 1]))
    }

    /// The observer and how light is received.
    pub fn vision(&self) -> &Vision {
        &self.vision
    }

    /// Kinetics of the L, M and S pigments.
    pub(crate) fn pigments(&self) -> &[Kinetics; 3] {
        &self.pigments
    }

    /// The model that was asked for.
    pub(crate) fn model(&self) -> Model {
        self.model
    }

    /// Pigment at every place.
    pub fn retina(&self) -> &Retina {
        &self.retina
    }

    /// What was left out, and what that can cost.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The places at full model beside the run, once one was looked at.
    pub fn check(&self) -> Option<&Check> {
        self.check.as_ref()
    }

    /// Where the first look was aimed, in pixels.
    pub(crate) fn first_gaze(&self) -> Option<[f64; 2]> {
        self.first_gaze
    }

    /// Scale of the picture, in both directions.
    pub fn pixels_per_degree(&self) -> f64 {
        self.pixels_per_degree
    }

    /// The plan as `report.json` has it.
    pub fn plan_report(&self) -> serde_json::Value {
        let mut report = self.plan.report(self.model, &self.pigments);
        if let Some(stage) = &self.optics {
            report["optics"] = stage.report();
        }
        report
    }

    /// The name of the model that was used so far.
    pub(crate) fn model_name(&self) -> &'static str {
        self.plan.name(self.model)
    }
}
