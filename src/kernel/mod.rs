//! The inner loops over a run of places: light -> cone illuminance, illuminance -> pigment, light
//! and pigment -> percept. Nowhere else is speed written.
//!
//! A *tile*, up to `TILE` places of one row, goes the whole way before the next one begins, so
//! that everything between the light and the percept stays in the first cache. Each loop does one
//! small thing to whole runs: those are the loops that compilers vectorise, here for whatever the
//! processor has, found when the program runs. Products and sums are never contracted, so the bits
//! are the same on every processor; each place is computed alike wherever its tile begins, so they
//! are the same however a row is cut.

mod bands;
mod between;
mod catch;
mod curve;
mod decay;
mod exposures;
mod extremes;
mod percept;
mod pigment;
mod sums;

pub(crate) use bands::BandSums;
pub(crate) use between::{Between, between, ramps};
pub(crate) use catch::{CatchForm, PlanesForm, catch, single};
pub(crate) use curve::Curve;
pub use exposures::{Exposures, steady_each, unbleached};
pub(crate) use extremes::{greatest, least};
pub(crate) use percept::{PerceptForm, percept};
pub(crate) use pigment::steady;
pub use pigment::{FirstOrderForm, relax};
pub(crate) use sums::{combine, floored, illuminance, weaken};

/// Most places of a tile: the planes of RGB light, trolands, pigment and percept of so many take 15
/// KiB.
pub(crate) const TILE: usize = 256;

/// Samples of a [`TileScratch`]'s light.
pub(crate) const ROOM: usize = 16 * TILE;

/// Where one tile is worked on. Made once for many rows: it is as large as many a row of a picture.
#[repr(align(64))]
pub(crate) struct TileScratch {
    /// Light, where it has to be converted or projected.
    pub(crate) light: [f32; ROOM],
    /// Cone illuminance of L, M, S, td.
    pub(crate) td: [[f32; TILE]; 3],
    /// The catches of L, M, S.
    pub(crate) lms: [[f32; TILE]; 3],
    /// The percept's R, G, B.
    pub(crate) rgb: [[f32; TILE]; 3],
}

impl TileScratch {
    /// An empty one.
    pub(crate) fn new() -> Self {
        let planes = || [[0.0; TILE]; 3];
        TileScratch { light: [0.0; ROOM], td: planes(), lms: planes(), rgb: planes() }
    }
}

impl Default for TileScratch {
    fn default() -> Self {
        TileScratch::new()
    }
}

/// The most places of a tile whose `planes` fit a [`TileScratch`].
pub(crate) fn tile(planes: usize) -> usize {
    let fitting = ROOM / planes.max(1);
    if fitting >= LANES { fitting / LANES * LANES } else { fitting.max(1) }.min(TILE)
}

/// Cuts a row into tiles of at most `tile` places: where each begins and how wide it is.
pub(crate) fn tiles(tile: usize, width: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..width).step_by(tile).map(move |from| (from, tile.min(width - from)))
}

/// Tiles are whole multiples of this where they can be: two of the longest vectors.
const LANES: usize = 32;

/// Asks for the run of samples that lies `ahead` of this one.
#[inline(always)]
pub(crate) fn prefetch_run<T>(run: &[T], ahead: usize) {
    for at in (0..run.len()).step_by(64 / size_of::<T>()) {
        prefetch(run.as_ptr().wrapping_add(ahead + at));
    }
}

/// Asks the processor for samples that will be wanted soon: a run that is read tile by tile, here
/// and there, comes from memory no faster than it is asked for.
#[inline(always)]
fn prefetch<T>(sample: *const T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing that the program could see, and faults at no address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(sample.cast()) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = sample;
}

/// Runs a loop compiled for the best that this processor has.
pub(crate) fn vectorised<Loop: pulp::WithSimd>(work: Loop) -> Loop::Output {
    pulp::Arch::new().dispatch(work)
}
