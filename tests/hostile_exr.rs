//! Damaged and malicious OpenEXR files: each is refused or read, none panics, hangs or takes
//! memory.

mod exr_raw;

use std::path::{Path, PathBuf};

use exr_raw::luminance_and_chroma;
use proptest::prelude::*;
use sungaze::frames::{About, ChannelNames, Compression, ReadOptions, open, write_exr};
use sungaze::light::{Planes, Samples};

/// Small files of every compression, and those of other programs.
fn victims() -> &'static [Vec<u8>] {
    static VICTIMS: std::sync::OnceLock<Vec<Vec<u8>>> = std::sync::OnceLock::new();
    VICTIMS.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("victim.exr");
        let values =
            (0..3 * 33 * 35u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 20) as f32 * 0.01);
        let float = Planes {
            width: 33,
            height: 35,
            count: 3,
            samples: Samples::Float(values.clone().collect()),
        };
        let half = Samples::Half(values.map(half::f16::from_f32).collect());
        let half = Planes { samples: half, ..float };
        let mut victims = Vec::new();
        for planes in [&float, &half] {
            for (_, compression) in Compression::ALL {
                write_exr(&path, &["R", "G", "B"], planes, compression, &About::default()).unwrap();
                victims.push(std::fs::read(&path).unwrap());
            }
        }
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
        let small = [
            "names_fichet6.exr",
            "names_units.exr",
            "pbrt_like_spectralfilm.exr",
            "mi_bitmap_fichet.exr",
        ];
        victims.extend(small.iter().map(|name| std::fs::read(data.join(name)).unwrap()));
        let chroma = |compression, lines| luminance_and_chroma(compression, lines, [-4, 2, 11, 37]);
        victims.extend([chroma(0, 1), chroma(3, 16)]);
        victims
    })
}

/// Opens and reads bytes as a file; whatever comes of it is fine.
fn read(bytes: &[u8]) {
    let path: PathBuf =
        std::env::temp_dir().join(format!("sungaze-hostile-{}.exr", std::process::id()));
    std::fs::write(&path, bytes).unwrap();
    for channels in [ChannelNames::Recognised, ChannelNames::Wavelength("{nm}".into())] {
        let options = ReadOptions { channels, max_pixels: 1 << 20, ..ReadOptions::default() };
        if let Ok(footage) = open(std::slice::from_ref(&path), &options) {
            let _ = footage.read(0, None, None);
        }
    }
    std::fs::remove_file(&path).unwrap();
}

/// Some hundred; `PROPTEST_CASES` asks for more.
fn cases() -> u32 {
    std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(600)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: cases(), failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn no_damage_to_an_exr_file_is_fatal(
        which in any::<prop::sample::Index>(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::weighted(0.2, any::<prop::sample::Index>()),
    ) {
        let mut bytes = which.get(victims()).clone();
        for (at, byte) in damage {
            *at.get_mut(&mut bytes) = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        read(&bytes);
    }
}
