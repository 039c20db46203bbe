//! The state that a run starts from, where it is a file.

use ndarray::Array3;

use crate::config::Config;
use crate::error::{Error, Result};
use crate::eye::retina::Retina;
use crate::frames;

/// The retina of a state file, which must be of the frames' size.
pub(crate) fn retina_of_file(
    config: &Config,
    file: &str,
    width: usize,
    height: usize,
) -> Result<Retina> {
    let path = config.path(file);
    let planes = frames::read_state(&path, config.settings.input.max_pixels)?;
    if (planes.width, planes.height) != (width, height) {
        let problem = format!(
            "is a state of {} x {} places; the frames have {width} x {height}",
            planes.width, planes.height
        );
        return Err(Error::file(&path, problem));
    }
    let p = Array3::from_shape_fn((height, 3, width), |(y, k, x)| planes.at(x, y, k));
    if p.iter().any(|v| !(0.0..=1.0).contains(v)) {
        return Err(Error::file(&path, "holds unbleached fractions outside 0 to 1"));
    }
    Ok(Retina::from_fractions(p.view(), [1.0; 3]))
}
