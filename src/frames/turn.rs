//! Orientation: how a stored picture is turned and mirrored before it is looked at.
//!
//! EXIF 2.32 (CIPA DC-008), tag 274: 1 as it stands, 2 to 4 mirrored or upside down, 5 to 8 on its
//! side.

/// From a place of the picture to its place in the file: exchanged, then mirrored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Turn {
    exchanged: bool,
    mirrored: [bool; 2],
}

impl Turn {
    /// The turn of an EXIF orientation; anything but 2 to 8 is none.
    pub(super) fn of_exif(orientation: u16) -> Turn {
        let (exchanged, x, y) = match orientation {
            2 => (false, true, false),
            3 => (false, true, true),
            4 => (false, false, true),
            5 => (true, false, false),
            6 => (true, false, true),
            7 => (true, true, true),
            8 => (true, true, false),
            _ => (false, false, false),
        };
        Turn { exchanged, mirrored: [x, y] }
    }

    /// Width and height of the turned picture.
    pub(super) fn size(self, width: usize, height: usize) -> (usize, usize) {
        if self.exchanged { (height, width) } else { (width, height) }
    }

    /// The column and row in the file, of a size, that column and row of the picture come from.
    pub(super) fn source(self, (x, y): (usize, usize), stored: (usize, usize)) -> (usize, usize) {
        let (x, y) = if self.exchanged { (y, x) } else { (x, y) };
        let mirror =
            |at: usize, mirrored, length: usize| if mirrored { length - 1 - at } else { at };
        (mirror(x, self.mirrored[0], stored.0), mirror(y, self.mirrored[1], stored.1))
    }
}

/// The orientation in a block of EXIF (a TIFF header and its first directory); 1 where it has none.
pub(super) fn exif_orientation(exif: &[u8]) -> u16 {
    orientation(exif).unwrap_or(1)
}

fn orientation(exif: &[u8]) -> Option<u16> {
    let little = match exif.get(..4)? {
        b"II*\0" => true,
        b"MM\0*" => false,
        _ => return None,
    };
    let short = |at: usize| -> Option<u16> {
        let bytes = exif.get(at..at + 2)?.try_into().ok()?;
        Some(if little { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) })
    };
    let long = |at: usize| -> Option<usize> {
        let bytes = exif.get(at..at + 4)?.try_into().ok()?;
        Some(if little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) } as usize)
    };
    let directory = long(4)?;
    let entries = (0..usize::from(short(directory)?)).map(|i| directory + 2 + 12 * i);
    let entry = entries.into_iter().find(|&at| short(at) == Some(274))?;
    short(entry + 8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the eight orientations make of a letter F, stored in 2 x 3 (EXIF's own figure).
    #[test]
    fn every_orientation_turns_as_the_standard_draws_it() {
        let stored = ["ab", "cd", "ef"];
        let expected = [
            "ab cd ef", "ba dc fe", "fe dc ba", "ef cd ab", "ace bdf", "eca fdb", "fdb eca",
            "bdf ace",
        ];
        for (orientation, expected) in (1..).zip(expected) {
            let turn = Turn::of_exif(orientation);
            let (width, height) = turn.size(2, 3);
            let row = |y| -> String {
                let letter = |x| {
                    let (column, row) = turn.source((x, y), (2, 3));
                    char::from(stored[row].as_bytes()[column])
                };
                (0..width).map(letter).collect()
            };
            let found: Vec<String> = (0..height).map(row).collect();
            assert_eq!(found.join(" "), expected, "{orientation}");
        }
    }

    #[test]
    fn orientation_is_found_in_either_byte_order_and_nowhere_in_garbage() {
        let little = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0";
        let big = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x08\0\0";
        assert_eq!((exif_orientation(little), exif_orientation(big)), (6, 8));
        for length in 0..little.len() {
            exif_orientation(&little[..length]);
        }
        assert_eq!(exif_orientation(b"II*\0\xff\xff\xff\xff"), 1);
    }
}
