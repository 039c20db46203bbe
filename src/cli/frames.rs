//! Frames without a configuration: `sungaze run sun.exr --fov 40 --white 5000`.

use std::path::Path;

use clap::Args;

use sungaze::config::Config;
use sungaze::error::{Error, Result};
use sungaze::frames::{self, Kind, Transfer};

/// What stands for keys of a configuration.
#[derive(Args, Clone)]
pub(crate) struct Keys {
    /// How many degrees the frames are across: input.horizontal_fov_deg
    #[arg(long, value_name = "DEG")]
    fov: Option<f64>,
    /// Luminance of the frames' (1, 1, 1): input.white_cd_m2
    #[arg(long, value_name = "CD_M2")]
    white: Option<f64>,
    /// How long a still is stared at: time.duration_s
    #[arg(long = "for", value_name = "SECONDS")]
    seconds: Option<f64>,
    /// Frames a second: time.fps
    #[arg(long, value_name = "N")]
    fps: Option<f64>,
}

/// Endings of the names of frames and films; anything else is a configuration.
const ENDINGS: [&str; 18] = [
    "exr", "hdr", "pic", "png", "jpg", "jpeg", "img", "raw", "dat", "bsq", "bil", "bip", "mp4",
    "mov", "mkv", "webm", "m4v", "y4m",
];

impl Keys {
    /// The configuration of a TOML file, of frames, or (`None`) of the built-in scene. `--set` goes
    /// before these keys. `command`: what is run, for the message that asks for what is missing.
    pub(crate) fn load(
        &self,
        path: Option<&Path>,
        set: &[String],
        command: &str,
    ) -> Result<Config> {
        let mut sets = self.sets();
        match path.filter(|path| is_frames(path)) {
            None => Config::load(path, &[sets, set.to_vec()].concat()),
            Some(path) => {
                sets.insert(0, setting("input.frames", quoted(path)));
                sets.extend_from_slice(set);
                self.ask(path, &sets, command)?;
                Config::parse("", "the command line", &name(path), Path::new(""), &sets)
            }
        }
    }

    fn sets(&self) -> Vec<String> {
        let keys = [
            ("input.horizontal_fov_deg", self.fov),
            ("input.white_cd_m2", self.white),
            ("time.duration_s", self.seconds),
            ("time.fps", self.fps),
        ];
        let given = keys.into_iter().filter_map(|(key, value)| Some((key, value?)));
        given.map(|(key, value)| setting(key, format!("{value:?}"))).collect()
    }

    /// Asks for all that the frames need and nobody has given, in one message.
    fn ask(&self, path: &Path, sets: &[String], command: &str) -> Result<()> {
        let given = |key: &str| sets.iter().any(|set| set.split('=').next() == Some(key));
        let (mut missing, mut whole) = (Vec::new(), format!("sungaze {command} {}", shell(path)));
        let config = Config::parse("", "the command line", "frames", Path::new(""), sets)?;
        let Some(sequence) = config.sequence()? else { return Ok(()) };
        let footage = frames::open(&sequence.files, &config.read_options()?)?;
        let header = footage.header();
        if !given("input.horizontal_fov_deg") && header.view.is_none() {
            missing.push("--fov DEG, how many degrees the picture is across");
            whole += " --fov 40";
        }
        let rgb = matches!(header.kind, Kind::Rgb(_));
        if let (Some(Transfer::Hlg(_)), false) = (header.transfer, given("input.peak_cd_m2")) {
            missing.push(
                "input.peak_cd_m2, of the display that HLG is shown on: the reference is 1000",
            );
            whole += " --set input.peak_cd_m2=1000";
        } else if !given("input.white_cd_m2") && rgb && header.white.is_none() {
            missing.push(
                "--white CD_M2, the luminance of (1, 1, 1): 100 for a picture made for a display, \
                 72983 for Mitsuba's hdrfilm, 179 for Radiance",
            );
            whole += " --white 100";
        }
        if missing.is_empty() {
            return Ok(());
        }
        let problem = format!("needs {}; such as: {whole}", missing.join("; and "));
        Err(Error::config("the command line", path.display().to_string(), problem))
    }
}

fn is_frames(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
}

fn setting(key: &str, value: String) -> String {
    format!("{key}={value}")
}

/// A path as a TOML string.
fn quoted(path: &Path) -> String {
    serde_json::Value::from(path.to_string_lossy()).to_string()
}

/// A path as a shell takes it.
fn shell(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:%@".contains(c);
    if text.chars().all(plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

/// The name of frames without their numbers: what their results are called.
fn name(path: &Path) -> String {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let name = stem.split(['#', '%', '$', '@']).next().unwrap_or_default();
    let name = name.trim_end_matches(['.', '_', '-']);
    if name.is_empty() { "frames".into() } else { name.to_owned() }
}
