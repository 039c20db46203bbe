//! Damaged PIZ blocks: each is refused or read, none panics, hangs or takes memory.

use exr::compression::Compression;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::prelude::Vec2;
use exr_blocks::piz::{Channel, decoded};
use proptest::prelude::*;

const SIZE: (usize, usize) = (37, 32);
const CHANNELS: [Channel; 2] =
    [Channel { wide: false, sampling: (1, 1) }, Channel { wide: true, sampling: (1, 1) }];

/// Blocks of few and of many values.
fn victims() -> &'static [Vec<u8>] {
    static VICTIMS: std::sync::OnceLock<Vec<Vec<u8>>> = std::sync::OnceLock::new();
    VICTIMS.get_or_init(|| [0, 3, 7, 9].map(victim).to_vec())
}

fn victim(bits: u32) -> Vec<u8> {
    let kinds = [("a", SampleType::F16), ("b", SampleType::F32)];
    let channels = kinds.map(|(name, kind)| ChannelDescription::named(name, kind));
    let size = Vec2(SIZE.0, SIZE.1);
    let header = Header::new("part".into(), size, channels.into_iter().collect());
    let header = header.with_encoding(
        Compression::PIZ,
        exr::meta::BlockDescription::ScanLines,
        exr::meta::attribute::LineOrder::Increasing,
    );
    let word =
        |i: usize| (((i as u32).wrapping_mul(2_654_435_761) >> 8) as u16) & ((1 << bits) - 1);
    let block = (0..3 * SIZE.0 * SIZE.1).flat_map(|i| word(i).to_le_bytes()).collect();
    let packed = Compression::PIZ.compress_image_section_to_le(
        &header,
        block,
        IntegerBounds::from_dimensions(size),
    );
    packed.ok().filter(|packed| packed.len() < 6 * SIZE.0 * SIZE.1).expect("should shrink")
}

fn cases() -> u32 {
    std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(600)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: cases(), failure_persistence: None, ..ProptestConfig::default()
    })]

    #[test]
    fn no_damage_to_a_piz_block_is_fatal(
        which in any::<prop::sample::Index>(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        head in prop::option::of((0usize..40, any::<u8>())),
        cut in prop::option::weighted(0.3, any::<prop::sample::Index>()),
    ) {
        let mut bytes = which.get(victims()).clone();
        for (at, byte) in damage {
            *at.get_mut(&mut bytes) = byte;
        }
        if let Some((at, byte)) = head {
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Ok(block) = decoded(&bytes, &CHANNELS, SIZE.0, 0..SIZE.1 as i32) {
            prop_assert_eq!(block.len(), 6 * SIZE.0 * SIZE.1);
        }
    }

    #[test]
    fn bytes_of_no_block_at_all_are_not_fatal(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = decoded(&bytes, &CHANNELS, SIZE.0, 0..SIZE.1 as i32);
    }
}

#[test]
fn a_block_that_is_cut_anywhere_is_refused() {
    for victim in victims() {
        for length in (0..victim.len()).step_by(7) {
            assert!(
                decoded(&victim[..length], &CHANNELS, SIZE.0, 0..SIZE.1 as i32).is_err(),
                "{length}"
            );
        }
        assert!(decoded(victim, &CHANNELS, SIZE.0, 0..SIZE.1 as i32).is_ok());
    }
}

#[test]
fn a_block_of_another_size_is_refused() {
    for victim in victims() {
        for (width, height) in [(36, 32), (38, 32), (37, 31), (37, 33)] {
            assert!(decoded(victim, &CHANNELS, width, 0..height).is_err(), "{width} x {height}");
        }
    }
}
