//! The places of the check: spread over the picture, and the extremes of its light.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use crate::light::Planes;
use crate::vision::{SampledSpectra, Vision};

/// Columns and rows of the grid of spread places.
const GRID: [usize; 2] = [16, 12];

/// How many of the brightest places are taken, and how many of the darkest.
const EXTREMES: usize = 32;

/// Keeps the [`EXTREMES`] least of what is shown to it.
fn keep<T: Ord>(least: &mut BinaryHeap<T>, value: T) {
    if least.len() < EXTREMES {
        least.push(value);
    } else if let Some(mut last) = least.peek_mut()
        && value < *last
    {
        *last = value;
    }
}

/// Where the [`EXTREMES`] least and as many greatest of some values stand.
fn extremes(values: impl Iterator<Item = f32>) -> Vec<usize> {
    let (mut least, mut greatest) = (BinaryHeap::new(), BinaryHeap::new());
    for (i, value) in values.enumerate() {
        // As integers in the order of `f32::total_cmp`.
        let bits = value.to_bits() as i32;
        let ranked = (bits ^ (((bits >> 31) as u32) >> 1) as i32, i);
        keep(&mut least, ranked);
        keep(&mut greatest, Reverse(ranked));
    }
    let least = least.into_iter().map(|(_, i)| i);
    least.chain(greatest.into_iter().map(|Reverse((_, i))| i)).collect()
}

/// The places to check: one in each cell of a grid, and the extremes of a frame's luminance.
pub fn places(vision: &Vision, planes: &Planes) -> Vec<[usize; 2]> {
    let [width, height] = [planes.width, planes.height];
    let jittered = (0..GRID[0] * GRID[1]).map(|i| {
        let cell = [i % GRID[0], i / GRID[0]];
        let within = [jitter(2 * i as u64), jitter(2 * i as u64 + 1)];
        let along = |axis: usize, n: usize| {
            let at = (cell[axis] as f64 + within[axis]) / GRID[axis] as f64 * n as f64;
            (at as usize).min(n - 1)
        };
        [along(0, width), along(1, height)]
    });
    let mut places: Vec<[usize; 2]> = jittered.collect();
    let light = (0..width * height).map(|i| luminance(vision, planes, [i % width, i / width]));
    if width * height > EXTREMES {
        places.extend(extremes(light).into_iter().map(|i| [i % width, i / width]));
    }
    places.sort_by_key(|&[x, y]| [y, x]);
    places.dedup();
    places
}

fn luminance(vision: &Vision, planes: &Planes, [x, y]: [usize; 2]) -> f32 {
    let terms = vision.luminance.iter().enumerate().filter(|(_, w)| **w != 0.0);
    terms.map(|(i, w)| w * planes.at(x, y, i)).sum::<f64>() as f32
}

/// A number from 0 to 1 that looks like chance and is always the same (splitmix64).
fn jitter(i: u64) -> f64 {
    let mut z = (i + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64
}

/// Room for the spectra of the places, to be filled while a frame is decoded.
pub(crate) fn room(vision: &Vision, places: &[[usize; 2]]) -> Option<Arc<SampledSpectra>> {
    vision.projection().map(|_| Arc::new(SampledSpectra::new(places)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_are_those_of_a_sorted_list() {
        let values: Vec<f32> =
            (0..5000).map(|i| ((i * 7919) % 997) as f32 - 400.0).chain([-0.0, 0.0]).collect();
        let mut ranked: Vec<usize> = (0..values.len()).collect();
        ranked.sort_by(|&a, &b| values[a].total_cmp(&values[b]).then(a.cmp(&b)));
        let mut expected: Vec<usize> =
            [&ranked[..EXTREMES], &ranked[ranked.len() - EXTREMES..]].concat();
        let mut found = extremes(values.iter().copied());
        expected.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, expected);
    }
}
