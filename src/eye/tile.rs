//! One tile under one frame: left untouched, set to its steady state, or followed.

use super::Census;
use crate::eye::plan::{LeftOut, Rule};
use crate::eye::retina::{Advance, Model};
use crate::kernel;

/// Moves a tile's L, M, S pigment by its light, td, as far as the rule asks for. `bound`: what the
/// tile may have lost unseen; `greatest`: of its light.
pub(super) fn moved(
    advance: &Advance,
    rule: &Rule,
    bound: &mut f64,
    td: [&[f32]; 3],
    greatest: [f32; 3],
    p: [&mut [f64]; 3],
) -> Census {
    let census = Census::of_light(greatest);
    *bound = rule.after(*bound, greatest);
    if bound.is_finite() {
        return Census { left_out: LeftOut { untouched: *bound, ..LeftOut::default() }, ..census };
    }
    let mut left_out = LeftOut { stepped: true, ..LeftOut::default() };
    let mut least = [1.0; 3];
    for k in 0..3 {
        let outlasted = rule.outlasts(k, greatest[k], || kernel::dimmest(td[k]));
        let model = if outlasted.is_some() { Model::Steady } else { advance.model };
        left_out.settled |= outlasted.is_some();
        left_out.outlasted = left_out.outlasted.max(outlasted.unwrap_or(0.0));
        left_out.followed |= matches!(model, Model::Tracked { .. });
        least[k] = advance.cone(k, model, td[k], p[k]);
    }
    let s_past_half =
        if least[2] < 0.5 { p[2].iter().filter(|&&p| p < 0.5).count() as u64 } else { 0 };
    Census { least, s_past_half, left_out, ..census }
}
