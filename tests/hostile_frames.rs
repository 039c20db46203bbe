//! Malicious headers and names: each is refused or read, none panics, hangs or takes memory.

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use sungaze::frames::{Missing, ReadOptions, Sequence, open};

/// Opens and reads bytes as a file; whatever comes of it is fine.
fn read(path: &Path, bytes: &[u8]) {
    std::fs::write(path, bytes).unwrap();
    let options = ReadOptions { max_pixels: 1 << 20, ..ReadOptions::default() };
    if let Ok(footage) = open(&[path.to_owned()], &options) {
        let _ = footage.read(0, None, None);
    }
    // Some file systems take milliseconds to overwrite a file, but none to write it anew.
    std::fs::remove_file(path).unwrap();
}

/// A folder of this test.
fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hostile").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
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
        let path = scratch("envi").join("a.hdr");
        let [samples, lines, bands, offset, order] = &claims[..] else { unreachable!() };
        let header = format!(
            "ENVI\nsamples = {samples}\nlines = {lines}\nbands = {bands}\nheader offset = {offset}\n\
             data type = {data_type}\ninterleave = {interleave}\nbyte order = {order}\n\
             wavelength = {{{}}}\n{more}",
            wavelengths.join(",")
        );
        let data = path.with_extension("img");
        if !data.exists() {
            std::fs::write(data, vec![63; 9000]).unwrap();
        }
        read(&path, header.as_bytes());
    }

    #[test]
    fn no_radiance_header_is_fatal(
        claims in prop::collection::vec(claim(), 5),
        sizes in (0u32..40, 0u32..40),
        signs in prop::sample::select(vec![("-Y", "+X"), ("+Y", "-X"), ("+X", "-Y"), ("", "")]),
        pixels in prop::collection::vec(any::<u8>(), 0..4000),
        plain in any::<bool>(),
    ) {
        let path = scratch("radiance").join("a.hdr");
        let [exposure, r, g, b, size] = &claims[..] else { unreachable!() };
        let width = if plain { sizes.0.to_string() } else { size.clone() };
        let (y, x) = signs;
        let mut bytes = format!(
            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE={exposure}\nCOLORCORR={r} {g} {b}\n\n{y} {} {x} {width}\n",
            sizes.1
        )
        .into_bytes();
        bytes.extend(pixels);
        read(&path, &bytes);
    }

    #[test]
    fn no_pattern_is_fatal(
        name in "(sun|s)?[.#@%$F0-9d]{0,10}(.exr)?|\\PC{0,10}",
        range in "[0-9x,-]{0,8}",
        which in 0u32..8,
        hold in any::<bool>(),
    ) {
        let folder = scratch(&format!("pattern{which}"));
        for number in (0..12).filter(|number| (number * 7 + which) % 5 > which % 4) {
            let path = folder.join(format!("sun.{number:04}.exr"));
            if !path.exists() {
                std::fs::write(path, "").unwrap();
            }
        }
        let missing = if hold { Missing::Hold } else { Missing::Error };
        if let Ok(sequence) = Sequence::find(&[name], &folder, &range, missing) {
            prop_assert!(!sequence.numbers.is_empty());
            prop_assert_eq!(sequence.numbers.len(), sequence.shows.len());
            prop_assert!(sequence.numbers.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert!(sequence.shows.iter().all(|file| *file < sequence.files.len()));
        }
    }
}
