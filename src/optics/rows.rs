//! The inner loops over rows of the pyramid, for whatever the processor has. Each sample is the
//! same sums of the same products in the same order wherever its vector begins, never contracted:
//! the bits are the same on every processor.

use pulp::{Simd, WithSimd};

use super::levels::{BINOMIAL, LONGEST};
use super::shape::{BLOCK, MARGIN};

/// Zeros on both sides of a row that is blurred along itself.
pub(super) const GUARD: usize = LONGEST;

/// Rows that are blurred together.
pub(super) const BAND: usize = 8;

/// Columns that go down a band at once: with the rows around them they fit the first cache.
const STRIP: usize = 2 * BLOCK;

/// A Gaussian's taps from the middle on; its weight is in those along rows.
#[derive(Clone, Debug)]
pub(super) struct Taps {
    pub(crate) down: Vec<f32>,
    pub(crate) along: Vec<f32>,
}

/// Rows of one plane around a band: row `i` of the band is row `i` + [`LONGEST`], rows outside of
/// the level are zeros.
pub(super) type Around<'a> = [&'a [f32]; BAND + 2 * LONGEST];

/// A band of one plane, blurred by several Gaussians that are added up.
pub(super) struct Blur<'a> {
    pub(crate) rows: &'a Around<'a>,
    pub(crate) gaussians: &'a [Taps],
    /// The rows blurred downwards, Gaussian by Gaussian, with zeros on both sides.
    pub(crate) between: &'a mut [f32],
    /// Whole rows of all planes.
    pub(crate) out: &'a mut [f32],
    pub(crate) stride: usize,
    /// Where the plane lies in a row.
    pub(crate) from: usize,
    pub(crate) width: usize,
}

/// Samples of a row between the passes.
pub(super) fn guarded(width: usize) -> usize {
    width + 2 * GUARD
}

impl WithSimd for Blur<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Blur { rows, gaussians, between, out, stride, from, width } = self;
        let (padded, band) = (guarded(width), out.len() / stride);
        for strip in (0..width).step_by(STRIP) {
            let columns = STRIP.min(width - strip);
            for (i, taps) in gaussians.iter().enumerate() {
                for y in 0..band {
                    let at = (i * BAND + y) * padded + GUARD + strip;
                    let radius = taps.down.len() - 1;
                    let rows = &rows[y + LONGEST - radius..=y + LONGEST + radius];
                    down(simd, rows, strip, &taps.down, &mut between[at..at + columns]);
                }
            }
        }
        for y in 0..band {
            let row = |i: usize| &between[(i * BAND + y) * padded..][..padded];
            along(simd, gaussians, row, &mut out[y * stride + from..][..width]);
        }
    }
}

/// Four vectors of a row.
#[inline(always)]
fn load<S: Simd>(row: &[f32], at: usize) -> [S::f32s; 4] {
    let vectors = S::as_simd_f32s(&row[at..at + 4 * S::F32_LANES]).0;
    [vectors[0], vectors[1], vectors[2], vectors[3]]
}

/// sum + tap (a + b), vector by vector.
#[inline(always)]
fn add<S: Simd>(simd: S, sum: &mut [S::f32s; 4], tap: f32, [a, b]: [[S::f32s; 4]; 2]) {
    let tap = simd.splat_f32s(tap);
    for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
        *sum = simd.add_f32s(*sum, simd.mul_f32s(tap, simd.add_f32s(a, b)));
    }
}

/// A symmetric filter from row to row; the row in the middle is the middle one.
#[inline(always)]
fn down<S: Simd>(simd: S, rows: &[&[f32]], from: usize, taps: &[f32], out: &mut [f32]) {
    let middle = taps.len() - 1;
    let first = simd.splat_f32s(taps[0]);
    for (i, out) in S::as_mut_simd_f32s(out).0.chunks_exact_mut(4).enumerate() {
        let at = from + 4 * S::F32_LANES * i;
        let mut sum = load::<S>(rows[middle], at).map(|v| simd.mul_f32s(first, v));
        for (j, &tap) in taps.iter().enumerate().skip(1) {
            add(
                simd,
                &mut sum,
                tap,
                [load::<S>(rows[middle - j], at), load::<S>(rows[middle + j], at)],
            );
        }
        out.copy_from_slice(&sum);
    }
}

/// Symmetric filters along guarded rows, one row a filter, added up.
#[inline(always)]
fn along<'a, S: Simd>(
    simd: S,
    gaussians: &[Taps],
    row: impl Fn(usize) -> &'a [f32],
    out: &mut [f32],
) {
    for (i, out) in S::as_mut_simd_f32s(out).0.chunks_exact_mut(4).enumerate() {
        let at = GUARD + 4 * S::F32_LANES * i;
        let mut sum = [simd.splat_f32s(0.0); 4];
        for (i, taps) in gaussians.iter().enumerate() {
            let (row, first) = (row(i), simd.splat_f32s(taps.along[0]));
            for (sum, v) in sum.iter_mut().zip(load::<S>(row, at)) {
                *sum = simd.add_f32s(*sum, simd.mul_f32s(first, v));
            }
            for (j, &tap) in taps.along.iter().enumerate().skip(1) {
                add(simd, &mut sum, tap, [load::<S>(row, at - j), load::<S>(row, at + j)]);
            }
        }
        out.copy_from_slice(&sum);
    }
}

/// Taps of the binomial filter.
const B: [f32; 4] =
    [BINOMIAL[0] as f32, BINOMIAL[1] as f32, BINOMIAL[2] as f32, BINOMIAL[3] as f32];

/// One row of a plane's coarser level from seven of its finer one.
pub(super) struct Reduce<'a> {
    pub(crate) rows: [&'a [f32]; 7],
    /// Room of three rows.
    pub(crate) room: &'a mut [f32],
    pub(crate) out: &'a mut [f32],
}

/// Samples of room for a row of the finer and one of the coarser level.
pub(super) fn reducing(fine: usize, coarse: usize) -> usize {
    fine + 2 * half(fine, coarse)
}

/// Every second sample of a row, with a margin before and behind.
fn half(fine: usize, coarse: usize) -> usize {
    (fine / 2).max(coarse) + 2 * MARGIN
}

impl WithSimd for Reduce<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Reduce { rows: [a, b, c, d, e, f, g], room, out } = self;
        let (fine, length) = (d.len(), half(d.len(), out.len()));
        let (whole, halves) = room.split_at_mut(fine);
        let (even, odd) = halves[..2 * length].split_at_mut(length);
        let pairs = [(a, g), (b, f), (c, e)].map(|(a, b)| (&a[..fine], &b[..fine]));
        for (x, out) in whole.iter_mut().enumerate() {
            let pair = |i: usize| pairs[i].0[x] + pairs[i].1[x];
            *out = B[0] * d[x] + B[1] * pair(2) + B[2] * pair(1) + B[3] * pair(0);
        }
        let (evens, odds) = (&mut even[MARGIN..][..fine / 2], &mut odd[MARGIN..][..fine / 2]);
        for ((even, odd), pair) in evens.iter_mut().zip(odds).zip(whole.as_chunks::<2>().0) {
            [*even, *odd] = *pair;
        }
        for ((out, e), o) in out.iter_mut().zip(even.windows(4)).zip(odd.windows(4)) {
            *out = B[0] * e[2] + B[1] * (o[1] + o[2]) + B[2] * (e[1] + e[3]) + B[3] * (o[0] + o[3]);
        }
    }
}

/// One row of a plane's finer level: four rows of its coarser one are added, expanded.
pub(super) struct Expand<'a> {
    /// Rows i - 1 to i + 2 for the rows 2 i and 2 i + 1.
    pub(crate) rows: [&'a [f32]; 4],
    pub(crate) odd: bool,
    /// Room of half a row and [`EXPANDING`].
    pub(crate) room: &'a mut [f32],
    pub(crate) out: &'a mut [f32],
}

/// Samples that an expanded row looks beyond half its length.
pub(super) const EXPANDING: usize = 2 * MARGIN;

impl WithSimd for Expand<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Expand { rows: [a, b, c, d], odd, room, out } = self;
        // The transpose of the reduction, and twice it: what a row lost in number of samples it regains in light.
        let taps = if odd { [B[3], B[1], B[1], B[3]] } else { [B[2], B[0], B[2], 0.0] }
            .map(|tap| 2.0 * tap);
        let length = (out.len() / 2 + EXPANDING).min(b.len());
        for (x, out) in room[..length].iter_mut().enumerate() {
            *out = taps[0] * a[x] + taps[1] * b[x] + taps[2] * c[x] + taps[3] * d[x];
        }
        for (pair, v) in out.as_chunks_mut::<2>().0.iter_mut().zip(room.windows(5)) {
            pair[0] += 2.0 * (B[0] * v[2] + B[2] * (v[1] + v[3]));
            pair[1] += 2.0 * (B[1] * (v[2] + v[3]) + B[3] * (v[1] + v[4]));
        }
    }
}

/// The light on the retina in one row of a plane.
pub(super) struct Exchange<'a> {
    pub(crate) light: &'a [f32],
    pub(crate) veil: &'a [f32],
    /// The share of a place's light that does not go to other places of the picture.
    pub(crate) kept: &'a [f32],
    /// The share that is not scattered at all, and the light beyond the picture; as bright as the
    /// place if `None`.
    pub(crate) beyond: Option<(f32, f32)>,
    pub(crate) out: &'a mut [f32],
}

impl WithSimd for Exchange<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Exchange { light, veil, kept, beyond, out } = self;
        let places = out.iter_mut().zip(light).zip(veil).zip(kept);
        match beyond {
            None => places.for_each(|(((out, light), veil), kept)| *out = light * kept + veil),
            Some((straight, outside)) => places.for_each(|(((out, light), veil), kept)| {
                *out = light * straight + veil + outside * (kept - straight).max(0.0);
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::vectorised;

    fn noise(length: usize) -> Vec<f32> {
        (0..length).map(|i| (i as f32 * 0.7).sin().abs() * 1e3).collect()
    }

    /// Runs a loop with this processor's vectors, and one by one.
    fn both(work: impl Fn(bool, &mut [f32], &mut [f32])) {
        let run = |scalar: bool| {
            let (mut room, mut out) =
                (vec![0.0; 2 * BAND * guarded(2 * BLOCK)], vec![0.0; BAND * 3 * BLOCK]);
            work(scalar, &mut room, &mut out);
            out
        };
        let vectors = run(false);
        assert!(vectors.iter().any(|v| *v != 0.0));
        assert_eq!(run(true), vectors);
    }

    fn start<W: WithSimd<Output = ()>>(scalar: bool, work: W) {
        if scalar { work.with_simd(pulp::Scalar) } else { vectorised(work) }
    }

    #[test]
    fn every_instruction_set_blurs_to_the_same_bits() {
        let (plane, width) = (noise(BAND * 16 * BLOCK), 2 * BLOCK);
        let rows: Around = std::array::from_fn(|i| &plane[37 * i..][..width]);
        let taps =
            |n: usize, scale: f32| noise(n).iter().map(|tap| scale * tap).collect::<Vec<f32>>();
        let gaussians = [5, 33].map(|n| Taps { down: taps(n, 1e-4), along: taps(n, 1e-3) });
        both(|scalar, between, out| {
            let (stride, from) = (3 * BLOCK, BLOCK);
            start(
                scalar,
                Blur { rows: &rows, gaussians: &gaussians, between, out, stride, from, width },
            );
        });
    }

    #[test]
    fn every_instruction_set_reduces_and_expands_to_the_same_bits() {
        let plane = noise(16 * BLOCK);
        both(|scalar, room, out| {
            let rows = std::array::from_fn(|i| &plane[41 * i..][..2 * BLOCK]);
            start(scalar, Reduce { rows, room, out: &mut out[..BLOCK] });
        });
        for odd in [false, true] {
            both(|scalar, room, out| {
                let rows = std::array::from_fn(|i| &plane[41 * i..][..BLOCK]);
                start(
                    scalar,
                    Expand {
                        rows,
                        odd,
                        room: &mut room[..BLOCK + EXPANDING],
                        out: &mut out[..2 * BLOCK],
                    },
                );
            });
        }
    }

    #[test]
    fn every_instruction_set_exchanges_to_the_same_bits() {
        let [light, veil, kept] = [0, 1, 2].map(|i| noise(64 + i).split_off(i));
        for beyond in [None, Some((0.4, 3.0))] {
            both(|scalar, _, out| {
                let (light, veil, kept) = (&light[..61], &veil[..61], &kept[..61]);
                start(scalar, Exchange { light, veil, kept, beyond, out: &mut out[..61] });
            });
        }
    }
}
