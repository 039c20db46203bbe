//! Our own 8-bit pictures, read back.

use std::io::Cursor;

/// Decodes a PNG of 8-bit colour, with or without alpha: width, height, and red, green, blue of
/// every pixel. `None` if the bytes are no such picture.
pub fn decode_png(bytes: &[u8]) -> Option<(usize, usize, Vec<u8>)> {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().ok()?;
    let mut samples = vec![0; reader.output_buffer_size()?];
    let info = reader.next_frame(&mut samples).ok()?;
    samples.truncate(info.buffer_size());
    let rgb = match (info.color_type, info.bit_depth) {
        (png::ColorType::Rgb, png::BitDepth::Eight) => samples,
        (png::ColorType::Rgba, png::BitDepth::Eight) => {
            samples.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
        }
        _ => return None,
    };
    Some((info.width as usize, info.height as usize, rgb))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_written_picture_comes_back_and_other_bytes_do_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let rgb: Vec<u8> = (0..36).collect();
        crate::frames::write_png(&path, 4, 3, &rgb).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(decode_png(&bytes), Some((4, 3, rgb)));
        assert_eq!(decode_png(&bytes[..bytes.len() / 2]), None);
        assert_eq!(decode_png(b"not a picture"), None);
    }
}
