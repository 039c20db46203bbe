//! Malicious headers and names: each is refused or read, none panics, hangs or takes memory.

use std::path::Path;

use proptest::prelude::*;
use sungaze::frames::{Missing, ReadOptions, Sequence, open};

/// Opens and reads a file; whatever comes of it is fine.
fn read(path: &Path) {
    let options = ReadOptions { max_pixels: 1 << 20, ..ReadOptions::default() };
    if let Ok(footage) = open(&[path.to_owned()], &options) {
        let _ = footage.read(0, None, None);
    }
}

fn cases() -> ProptestConfig {
    ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() }
}

/// A number as a header may claim it.
fn claim() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => (0u64..40).prop_map(|number| number.to_string()),
        1 => any::<i64>().prop_map(|number| number.to_string()),
        1 => any::<f64>().prop_map(|number| number.to_string()),
        1 => "[0-9eE.+{},; -]{0,8}|\\PC{0,4}",
    ]
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn no_envi_header_is_fatal(
        claims in prop::collection::vec(claim(), 5),
        data_type in prop::sample::select(vec!["2", "4", "5", "12", "6", ""]),
        interleave in prop::sample::select(vec!["bsq", "bil", "bip", "BIP", "x"]),
        wavelengths in prop::collection::vec(claim(), 0..5),
        more in "((fwhm|wavelength units|data ignore value|reflectance scale factor|;|\\{) ?=? ?[{},0-9a-z.]{0,9}\\n){0,3}",
    ) {
        let folder = tempfile::tempdir().unwrap();
        let [samples, lines, bands, offset, order] = &claims[..] else { unreachable!() };
        let header = format!(
            "ENVI\nsamples = {samples}\nlines = {lines}\nbands = {bands}\nheader offset = {offset}\n\
             data type = {data_type}\ninterleave = {interleave}\nbyte order = {order}\n\
             wavelength = {{{}}}\n{more}",
            wavelengths.join(",")
        );
        std::fs::write(folder.path().join("a.img"), vec![63; 9000]).unwrap();
        let path = folder.path().join("a.hdr");
        std::fs::write(&path, header).unwrap();
        read(&path);
    }

    #[test]
    fn no_radiance_header_is_fatal(
        claims in prop::collection::vec(claim(), 5),
        sizes in (0u32..40, 0u32..40),
        signs in prop::sample::select(vec![("-Y", "+X"), ("+Y", "-X"), ("+X", "-Y"), ("", "")]),
        pixels in prop::collection::vec(any::<u8>(), 0..4000),
        plain in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let [exposure, r, g, b, size] = &claims[..] else { unreachable!() };
        let width = if plain { sizes.0.to_string() } else { size.clone() };
        let (y, x) = signs;
        let mut bytes = format!(
            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE={exposure}\nCOLORCORR={r} {g} {b}\n\n{y} {} {x} {width}\n",
            sizes.1
        )
        .into_bytes();
        bytes.extend(pixels);
        let path = folder.path().join("a.hdr");
        std::fs::write(&path, bytes).unwrap();
        read(&path);
    }

    #[test]
    fn no_pattern_is_fatal(
        name in "(sun|s)?[.#@%$F0-9d]{0,10}(.exr)?|\\PC{0,10}",
        range in "[0-9x,-]{0,8}",
        numbers in prop::collection::vec(0u32..12, 0..6),
        hold in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        for number in numbers {
            std::fs::write(folder.path().join(format!("sun.{number:04}.exr")), "").unwrap();
        }
        let missing = if hold { Missing::Hold } else { Missing::Error };
        if let Ok(sequence) = Sequence::find(&[name], folder.path(), &range, missing) {
            prop_assert!(!sequence.numbers.is_empty());
            prop_assert_eq!(sequence.numbers.len(), sequence.shows.len());
            prop_assert!(sequence.numbers.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert!(sequence.shows.iter().all(|file| *file < sequence.files.len()));
        }
    }
}
