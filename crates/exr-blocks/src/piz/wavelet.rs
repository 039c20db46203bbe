//! The inverse of PIZ's wavelet: Haar's, level by level from the coarsest, in place, on 16-bit
//! words that wrap.
//!
//! A pair (a, b) was turned into (m, d), mean and difference. Where all ranks are below 2^14 the
//! difference has a sign; else both are modulo 2^16 and the mean is off by half of that where the
//! difference is negative.

/// Ranks below this have differences with a sign.
const SIGNED: u16 = 1 << 14;

/// Undoes the transform of a plane of `width * height` samples of one word, or of two, each word by
/// itself.
pub(super) fn undo(plane: &mut [u16], size: (usize, usize), wide: bool, largest: u16) {
    match (wide, largest < SIGNED) {
        (false, true) => levels(plane.as_chunks_mut::<1>().0, size, signed),
        (false, false) => levels(plane.as_chunks_mut::<1>().0, size, modular),
        (true, true) => levels(plane.as_chunks_mut::<2>().0, size, signed),
        (true, false) => levels(plane.as_chunks_mut::<2>().0, size, modular),
    }
}

fn signed(m: u16, d: u16) -> (u16, u16) {
    let a = m.wrapping_add(d & 1).wrapping_add((d as i16 >> 1) as u16);
    (a, a.wrapping_sub(d))
}

fn modular(m: u16, d: u16) -> (u16, u16) {
    let b = m.wrapping_sub(d >> 1);
    (d.wrapping_add(b).wrapping_sub(1 << 15), b)
}

/// A pair of samples, word by word.
#[inline(always)]
fn pair<const N: usize>(m: &mut [u16; N], d: &mut [u16; N], undo: impl Fn(u16, u16) -> (u16, u16)) {
    for (m, d) in m.iter_mut().zip(d) {
        (*m, *d) = undo(*m, *d);
    }
}

#[inline(always)]
fn levels<const N: usize>(
    plane: &mut [[u16; N]],
    (width, height): (usize, usize),
    undo: impl Fn(u16, u16) -> (u16, u16) + Copy,
) {
    let coarsest = width.min(height).checked_ilog2().unwrap_or(0);
    for level in (0..coarsest).rev() {
        let step = 1 << level;
        let mut bands = plane.chunks_exact_mut(2 * step * width);
        for band in &mut bands {
            let (upper, lower) = band.split_at_mut(step * width);
            rows(&mut upper[..width], &mut lower[..width], step, undo);
        }
        let left = bands.into_remainder();
        if height & step != 0 {
            let mut pairs = left[..width].chunks_exact_mut(2 * step);
            pairs.by_ref().for_each(|four| {
                let (left, right) = four.split_at_mut(step);
                pair(&mut left[0], &mut right[0], undo);
            });
        }
    }
}

/// Two rows that are `step` apart, in squares of four samples that are `step` apart.
#[inline(always)]
fn rows<const N: usize>(
    upper: &mut [[u16; N]],
    lower: &mut [[u16; N]],
    step: usize,
    undo: impl Fn(u16, u16) -> (u16, u16) + Copy,
) {
    let odd = upper.len() & step != 0;
    let last = upper.len() / (2 * step) * 2 * step;
    if step == 1 {
        for (upper, lower) in
            upper.as_chunks_mut::<2>().0.iter_mut().zip(lower.as_chunks_mut::<2>().0)
        {
            let ([a, b], [c, d]) = (upper, lower);
            square(a, b, c, d, undo);
        }
    } else {
        for (upper, lower) in upper.chunks_exact_mut(2 * step).zip(lower.chunks_exact_mut(2 * step))
        {
            let ((a, b), (c, d)) = (upper.split_at_mut(step), lower.split_at_mut(step));
            square(&mut a[0], &mut b[0], &mut c[0], &mut d[0], undo);
        }
    }
    if odd {
        pair(&mut upper[last], &mut lower[last], undo);
    }
}

#[inline(always)]
fn square<const N: usize>(
    a: &mut [u16; N],
    b: &mut [u16; N],
    c: &mut [u16; N],
    d: &mut [u16; N],
    undo: impl Fn(u16, u16) -> (u16, u16) + Copy,
) {
    pair(a, c, undo);
    pair(b, d, undo);
    pair(a, b, undo);
    pair(c, d, undo);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_come_back_from_their_means_and_differences() {
        for (a, b) in [(0u16, 0), (13, 54), (16_383, 0), (0, 16_383), (1, 2), (16_383, 16_383)] {
            let (m, d) = ((i32::from(a) + i32::from(b)) >> 1, i32::from(a) - i32::from(b));
            assert_eq!(signed(m as u16, d as u16), (a, b));
        }
        for (a, b) in [(0u16, 0), (65_535, 0), (0, 65_535), (40_000, 39_999), (16_384, 50_000)] {
            let (above, below) = (i32::from(a ^ 0x8000), i32::from(b));
            let (m, d) = ((above + below) >> 1, above - below);
            let m = if d < 0 { m + 0x8000 } else { m };
            assert_eq!(modular(m as u16, d as u16), (a, b));
        }
    }

    #[test]
    fn planes_too_thin_for_a_pair_stay_as_they_are() {
        for size in [(1, 5), (5, 1), (1, 1)] {
            let mut plane = vec![7, 1, 2, 3, 4];
            undo(&mut plane, size, false, 100);
            assert_eq!(plane, [7, 1, 2, 3, 4]);
        }
    }
}
