//! State files: the unbleached fraction of each pigment at every place, as OpenEXR.

use std::path::Path;

use crate::error::{Error, Result};
use crate::frames::exr_file::ExrFile;
use crate::frames::written::{About, Compression, write_exr};
use crate::light::{Planes, Samples};

/// Channels of a state file, in the order of L, M, S.
pub(super) const CHANNELS: [&str; 3] = ["unbleached.L", "unbleached.M", "unbleached.S"];

/// Writes three float planes of unbleached fractions. `note`: JSON for the attribute `sungaze`.
pub(crate) fn write_state(path: &Path, planes: &Planes, note: &str) -> Result<()> {
    let about = About { sungaze: Some(note.to_owned()), ..About::default() };
    write_exr(path, &CHANNELS, planes, Compression::Zip, &about)
}

/// Reads a state file: three float planes, shape of its display window.
pub(crate) fn read_state(path: &Path, max_pixels: u64) -> Result<Planes> {
    let file = ExrFile::open(path)?;
    let part = file.part(0, max_pixels)?;
    let names: Vec<String> = part.header.channels.list.iter().map(|c| c.name.to_string()).collect();
    let mut places = Vec::new();
    for wanted in CHANNELS {
        let Some(channel) = names.iter().position(|name| name == wanted) else {
            let problem = format!(
                "is not a state file: found channels {}; needed {}",
                names.join(", "),
                CHANNELS.join(", ")
            );
            return Err(Error::file(path, problem));
        };
        places.push(part.place(channel));
    }
    let width = part.width();
    let mut samples = vec![0.0f32; 3 * width * part.height()];
    part.decode(&mut samples, 3 * width, |rows, out, _| {
        for (i, _) in rows.rows() {
            for (plane, &place) in places.iter().enumerate() {
                rows.fetch(i, place, &mut out[(i * 3 + plane) * width..][rows.columns()]);
            }
        }
    })?;
    Ok(Planes { width, height: part.height(), count: 3, samples: Samples::Float(samples) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_comes_back_as_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state.exr");
        let samples = (0..3 * 7 * 5).map(|i| i as f32 / 105.0).collect();
        let planes = Planes { width: 7, height: 5, count: 3, samples: Samples::Float(samples) };
        write_state(&path, &planes, "{}").unwrap();
        assert_eq!(read_state(&path, 1000).unwrap(), planes);
    }

    #[test]
    fn a_picture_is_no_state() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.exr");
        write_exr(
            &path,
            &["R", "G", "B"],
            &Planes::float(2, 2, 3),
            Compression::None,
            &About::default(),
        )
        .unwrap();
        let problem = read_state(&path, 1000).unwrap_err().to_string();
        assert!(problem.contains("unbleached.L") && problem.contains("picture.exr"), "{problem}");
    }
}
