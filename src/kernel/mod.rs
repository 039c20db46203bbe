//! The inner loops over one row: light -> cone illuminance, illuminance -> pigment, light and pigment -> percept.
//!
//! A row is the unit of work: no allocation and no dispatch inside. Rows of three planes hold L, M, S (or R, G, B)
//! one after the other.

mod percept;
mod pigment;

pub use percept::{PerceptForm, percept};
pub use pigment::{FirstOrderForm, relax, steady};

/// Cone illuminance of a row, td: a linear form of the planes for each cone, never negative.
///
/// `weights[cone]` holds one weight a plane, `planes` the planes one after the other, `out` three rows.
pub fn illuminance(planes: &[f32], weights: &[Vec<f32>; 3], out: &mut [f32]) {
    let width = out.len() / 3;
    for (weights, sums) in weights.iter().zip(out.chunks_exact_mut(width)) {
        combine(planes, weights, sums);
        sums.iter_mut().for_each(|v| *v = v.max(0.0));
    }
}

/// A linear form of the planes of a row; planes of weight zero are passed over.
pub fn combine(planes: &[f32], weights: &[f32], out: &mut [f32]) {
    out.fill(0.0);
    for (&weight, plane) in weights.iter().zip(planes.chunks_exact(out.len())) {
        if weight != 0.0 {
            out.iter_mut().zip(plane).for_each(|(sum, v)| *sum += weight * v);
        }
    }
}
