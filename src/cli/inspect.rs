//! `sungaze inspect`.

use std::path::PathBuf;
use std::process::ExitCode;

use sungaze::colour;
use sungaze::config::Config;
use sungaze::error::Result;
use sungaze::frames::{self, Header, Kind};
use sungaze::observer::Observer;

use super::{Common, say};

/// Describes each file; one that cannot be read is named, and the others go on.
pub(crate) fn command(files: &[PathBuf], common: &Common) -> Result<ExitCode> {
    let config = Config::load(None, &common.set)?;
    common.pool()?;
    let options = config.read_options()?;
    let observer = config.observer();
    let white = config.settings.input.white_cd_m2;
    let weights = |header: &Header| luminance_weights(header, &observer, white);
    let (mut found, mut failed) = (Vec::new(), None);
    for file in files {
        match frames::inspect(file, &options, &weights) {
            Ok(inspection) if common.json => found.push(serde_json::json!(inspection)),
            Ok(inspection) => say::result(&inspection.to_string())?,
            Err(error) => {
                say::failure(&error);
                failed = Some(error);
            }
        }
    }
    if common.json {
        say::result(&format!("{:#}", serde_json::Value::Array(found)))?;
    }
    Ok(failed.map_or(ExitCode::SUCCESS, |error| ExitCode::from(error.exit_code())))
}

/// What each plane adds to the luminance in cd/m2; nothing for RGB whose white is not known.
fn luminance_weights(header: &Header, observer: &Observer, white: Option<f64>) -> Option<Vec<f64>> {
    match &header.kind {
        Kind::Rgb(primaries) => {
            let white = white.or(header.white.map(|nits| nits.0))?;
            Some(colour::rgb_to_xyz(primaries)?[1].iter().map(|y| y * white).collect())
        }
        Kind::Spectral(bands) => {
            let v = observer.luminous_efficiency().over(bands);
            Some(v.into_iter().map(|weight| observer.lumens_per_watt * weight).collect())
        }
    }
}
