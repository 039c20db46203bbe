//! An eye put together from its parts.

use super::percept::PerceptStage;
use super::pigment::Model;
use super::plan::{self, Plan};
use super::retina::Retina;
use super::scattered::OpticsStage;
use super::{Eye, Surround};
use crate::error::{Error, Result};
use crate::kinetics::Kinetics;
use crate::observer::Pupil;
use crate::optics::{Draw, Optics};
use crate::step;
use crate::units::Degrees;
use crate::vision::Vision;

/// An eye to be: its light and size are given, all else is the standard observer's.
pub struct EyeBuilder(Eye);

impl EyeBuilder {
    /// Kinetics of the L, M and S pigments.
    pub fn pigments(mut self, pigments: [Kinetics; 3]) -> Self {
        self.0.pigments = pigments;
        self
    }

    /// How pigment follows light. `budget`: largest error of p and of a catch up to which less may
    /// be modelled; `None`: the model is used everywhere.
    pub fn model(mut self, model: Model, budget: Option<f64>) -> Self {
        (self.0.model, self.0.plan) = (model, Plan::new(budget));
        self
    }

    /// Light scattered in the eye, in pictures of this size and scale; `None`: not at all.
    pub fn optics(mut self, optics: Option<Optics>, draw: Draw) -> Self {
        self.0.optics = optics.map(|optics| OpticsStage::new(optics, draw));
        self
    }

    /// What lies beyond the picture.
    pub fn surround(mut self, surround: Surround) -> Self {
        self.0.surround = surround;
        self
    }

    /// The retina to start with, of the picture's size.
    pub(crate) fn retina(mut self, retina: Retina) -> Self {
        self.0.retina = retina;
        self
    }

    /// Starts at the steady state of the first frame.
    pub(crate) fn adapted(mut self) -> Self {
        self.0.adapts_first = true;
        self
    }

    /// The eye.
    ///
    /// # Errors
    /// A size or a scale is zero or not finite, or the retina is of another size.
    pub fn build(self) -> Result<Eye> {
        let mut eye = self.0;
        eye.optics = eye.optics.map(|optics| optics.within(eye.surround));
        eye.retina = eye.retina.with_cells(eye.optics.as_ref().map(OpticsStage::extent));
        let [width, height] = eye.size;
        if width == 0 || height == 0 || eye.retina.size() != eye.size {
            let problem = format!(
                "a picture of {width} x {height} pixels on a retina of {:?} places; accepted: \
                 sizes above 0 that agree",
                eye.retina.size()
            );
            return Err(Error::light(problem));
        }
        if !(eye.pixels_per_degree.is_finite() && eye.pixels_per_degree > 0.0) {
            return Err(Error::light("the field of view is not above 0 degrees"));
        }
        Ok(eye)
    }
}

impl Eye {
    /// An eye to be, for light as an observer receives it.
    pub fn builder(vision: Vision, size: [usize; 2], across: Degrees) -> EyeBuilder {
        let (percept, around) = (PerceptStage::new(&vision), vision.equal_energy_moments());
        let model = Model::Tracked {
            method: step::EXACT,
            substeps: 0,
            budget: plan::SUBSTEPS * plan::BUDGET,
        };
        EyeBuilder(Eye {
            pupil: Pupil::new(vision.observer.pupil, vision.observer.dynamics),
            vision,
            pigments: Kinetics::standard(),
            model,
            size,
            pixels_per_degree: size[0] as f64 / across.0,
            adapts_first: false,
            retina: Retina::rested(size[0], size[1]),
            plan: Plan::new(Some(plan::BUDGET)),
            check: None,
            first_gaze: None,
            surround: Surround::Edge,
            optics: None,
            percept,
            illuminance: None,
            around,
            fields: Vec::new(),
            uniform: None,
            spare: None,
            frame: None,
            bands: None,
        })
    }
}
