//! `sungaze view`.

use std::path::Path;
use std::process::ExitCode;

use clap::Args;

use sungaze::config::settings::Scene;
use sungaze::error::{Error, Result};
use sungaze::view::View;

use super::frames::Keys;
use super::{Common, say, stop};

/// What `view` is asked for beside the common flags.
#[derive(Args)]
pub(crate) struct Asked {
    /// Port of 127.0.0.1 [default: a free one]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Only print the address, open no browser.
    #[arg(long)]
    no_open: bool,
    /// Width of the picture, pixels; wider frames are reduced to it [default: the configuration's, or 960]
    #[arg(long, value_name = "N")]
    width: Option<u32>,
}

/// Serves a configuration until the program is stopped.
pub(crate) fn command(
    path: Option<&Path>,
    keys: &Keys,
    asked: &Asked,
    common: &Common,
) -> Result<ExitCode> {
    let mut config = keys.load(path, &common.set, "view")?;
    common.pool()?;
    let silent = !config.gives("input.width") && config.settings.input.scene != Some(Scene::Field);
    let width = asked.width.or(silent.then_some(960));
    if let Some(width) = width {
        config = config.with_values(&[("input.width".into(), width.into())])?;
    }
    let folder = common.folder("view");
    let view = View::start(config, asked.port, folder)?;
    say::result(&view.url())?;
    if !asked.no_open {
        open(&view.url());
    }
    stop::wait();
    Ok(ExitCode::from(Error::Interrupted { resumable: false }.exit_code()))
}

/// Asks the system's own opener for a browser. Where there is none, the address is printed all the same.
fn open(url: &str) {
    let opener = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    let mut command = std::process::Command::new(opener);
    let quiet = std::process::Stdio::null;
    let _ = command.arg(url).stdin(quiet()).stdout(quiet()).stderr(quiet()).spawn();
}
