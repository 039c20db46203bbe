//! What may have bleached unseen, tile by tile and step by step.

/// What a plan allows over one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rule {
    pub(super) per_half_bleach: [f64; 3],
    pub(super) share: [f64; 3],
    pub(super) allowed: f64,
}

impl Rule {
    /// What may have bleached unseen after a step whose light is at most `greatest`, td; infinity
    /// once that is too much to be left out.
    pub(crate) fn after(&self, bound: f64, greatest: [f32; 3]) -> f64 {
        if bound.is_infinite() {
            return bound;
        }
        let after = self.bleached(bound, greatest.map(f64::from));
        if after < self.allowed { after } else { f64::INFINITY }
    }

    pub(super) fn bleached(&self, bound: f64, greatest: [f64; 3]) -> f64 {
        let of_cone =
            |k: usize| bound + self.share[k] * (greatest[k] * self.per_half_bleach[k] - bound);
        (0..3).map(of_cone).fold(0.0, f64::max)
    }
}
