//! The last two stages of a tile: its catches through what pigment is left, and their percept.

use crate::kernel::{self, CatchForm, PerceptForm, TILE};
use crate::light::PlaneTile;
use crate::vision::Vision;

/// Catch and percept of one vision.
pub(super) struct PerceptStage {
    catch: CatchForm,
    percept: PerceptForm,
}

/// Memory for one tile's p in single precision, its catches and its percept.
pub(super) struct PerceptScratch<'a> {
    pub(crate) p: &'a mut [[f32; TILE]; 3],
    pub(crate) lms: &'a mut [[f32; TILE]; 3],
    pub(crate) rgb: &'a mut [[f32; TILE]; 3],
}

impl PerceptStage {
    pub(super) fn new(vision: &Vision) -> Self {
        PerceptStage { catch: vision.catch_form(), percept: vision.percept_form() }
    }

    /// The percept of a tile of light through unbleached fractions p: R, G, B.
    pub(super) fn see<'a>(
        &self,
        light: PlaneTile<'_>,
        p: [&[f64]; 3],
        scratch: PerceptScratch<'a>,
    ) -> [&'a [f32]; 3] {
        let (width, PerceptScratch { p: single, lms, rgb }) = (light.width(), scratch);
        kernel::single(p, single);
        kernel::catch(&self.catch, light, single, lms.each_mut().map(|lms| &mut lms[..width]));
        let lms = lms.each_ref().map(|lms| &lms[..width]);
        let out = rgb.each_mut().map(|rgb| &mut rgb[..width]);
        kernel::percept(&self.percept, light, single, lms, out);
        rgb.each_ref().map(|rgb| &rgb[..width])
    }
}
