//! Pixels of Radiance: four bytes, three mantissas and an exponent that they share, in runs.
//!
//! Ward (1991), "Real Pixels", Graphics Gems II; the Radiance reference manual, "File Formats". A
//! mantissa m under the exponent e is (m + 0.5) 2^(e - 136), the middle of what it may stand for,
//! as Radiance's own `colr_color` has it; an exponent of 0 is black.

use std::io::{self, Read};

/// One pixel as it is stored.
pub(super) type Rgbe = [u8; 4];

/// Widths that the runs of single components are written for.
const RUN_WIDTHS: std::ops::Range<usize> = 8..0x8000;

/// The numbers of a pixel.
pub(super) fn numbers([r, g, b, exponent]: Rgbe) -> [f32; 3] {
    if exponent == 0 {
        return [0.0; 3];
    }
    let scale = f64::from(i32::from(exponent) - 136).exp2();
    [r, g, b].map(|mantissa| ((f64::from(mantissa) + 0.5) * scale) as f32)
}

/// Reads one scan line.
pub(super) fn read_line(reader: &mut impl Read, line: &mut [Rgbe]) -> io::Result<()> {
    let first = four(reader)?;
    let width = line.len();
    let by_component =
        first[..2] == [2, 2] && usize::from(first[2]) << 8 | usize::from(first[3]) == width;
    if by_component && RUN_WIDTHS.contains(&width) {
        return (0..4).try_for_each(|component| read_component(reader, line, component));
    }
    read_pixels(reader, line, first)
}

/// One component of every pixel, in runs of up to 127 and stretches of up to 128.
fn read_component(reader: &mut impl Read, line: &mut [Rgbe], component: usize) -> io::Result<()> {
    let mut at = 0;
    while at < line.len() {
        let count = usize::from(one(reader)?);
        let (count, run) = if count > 128 { (count - 128, true) } else { (count, false) };
        let stretch = line.get_mut(at..at + count).filter(|stretch| !stretch.is_empty());
        let stretch = stretch.ok_or_else(|| damaged("a run is longer than its line"))?;
        let value = if run { Some(one(reader)?) } else { None };
        for pixel in stretch {
            pixel[component] = match value {
                Some(value) => value,
                None => one(reader)?,
            };
        }
        at += count;
    }
    Ok(())
}

/// Whole pixels; (1, 1, 1, n) repeats the one before n times, and 256 n times if it comes next.
fn read_pixels(reader: &mut impl Read, line: &mut [Rgbe], first: Rgbe) -> io::Result<()> {
    let (mut next, mut at, mut shift) = (first, 0usize, 0);
    loop {
        if next[..3] == [1, 1, 1] {
            let before = at.checked_sub(1).map(|before| line[before]);
            let count = usize::from(next[3]).checked_shl(shift).unwrap_or(usize::MAX);
            let run = at.checked_add(count).and_then(|end| line.get_mut(at..end));
            let (Some(before), Some(run)) = (before, run) else {
                return Err(damaged("a run is longer than its line"));
            };
            run.fill(before);
            (at, shift) = (at + count, shift + 8);
        } else {
            line[at] = next;
            (at, shift) = (at + 1, 0);
        }
        if at == line.len() {
            return Ok(());
        }
        next = four(reader)?;
    }
}

fn one(reader: &mut impl Read) -> io::Result<u8> {
    let mut byte = [0];
    reader.read_exact(&mut byte)?;
    Ok(byte[0])
}

fn four(reader: &mut impl Read) -> io::Result<Rgbe> {
    let mut pixel = [0; 4];
    reader.read_exact(&mut pixel)?;
    Ok(pixel)
}

fn damaged(problem: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, problem)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn mantissas_are_taken_at_their_middle() {
        assert_eq!(numbers([128, 0, 255, 129]), [128.5 / 128.0, 0.5 / 128.0, 255.5 / 128.0]);
        assert_eq!(numbers([128, 128, 128, 0]), [0.0; 3]);
        assert!(numbers([255, 255, 255, 255]).iter().all(|number| number.is_finite()));
    }

    #[test]
    fn every_way_to_pack_a_line_gives_the_same_pixels() {
        let (a, b) = ([9, 8, 7, 129], [5, 5, 5, 130]);
        let mut line = [a; 9];
        line[8] = b;
        let flat: Vec<u8> = line.concat();
        let old = [&a[..], &[1, 1, 1, 7], &b].concat();
        let mut new = vec![2, 2, 0, 9];
        for i in 0..4 {
            new.extend([128 + 8, a[i], 1, b[i]]);
        }
        for bytes in [flat, old, new] {
            let mut read = [[0; 4]; 9];
            read_line(&mut &bytes[..], &mut read).unwrap();
            assert_eq!(read, line);
            assert!(read_line(&mut &bytes[..bytes.len() - 1], &mut read).is_err());
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn no_bytes_are_fatal(mut bytes in prop::collection::vec(prop_oneof![Just(1u8), Just(2), any::<u8>()], 0..99), width in 1usize..40) {
            let _ = read_line(&mut &bytes[..], &mut vec![[0; 4]; width]);
            bytes.splice(0..0, [2, 2, 0, width as u8]);
            let _ = read_line(&mut &bytes[..], &mut vec![[0; 4]; width]);
        }
    }
}
