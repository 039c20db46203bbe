//! What is looked at, and by whom: footage, the observer's vision of it, and the frames in time.

use crate::colour::Primaries;
use std::path::PathBuf;

use crate::config::Config;
use crate::config::settings::Input;
use crate::error::{Error, Result};
use crate::eye::{Eye, plan};
use crate::frames::{
    self, About, Footage, Header, Kind, Overscan, ReadOptions, Transfer, View, builtin,
};
use crate::optics::{Optics, Psf};
use crate::run::reader::Sequence;
use crate::run::schedule::{self, Step};
use crate::run::start::retina_of_file;
use crate::units::{Degrees, Nits};
use crate::vision::Vision;

/// Footage, vision and schedule of one run.
pub struct Scene {
    pub(crate) footage: Box<dyn Footage>,
    pub(crate) vision: Vision,
    pub(crate) pixels_per_degree: f64,
    /// The frames by their own times, and as they are looked at.
    #[cfg_attr(not(feature = "view"), expect(dead_code, reason = "only a view reads them"))]
    pub(crate) frames: Vec<Step>,
    pub(crate) steps: Vec<Step>,
    /// The files of its frames; none for the built-in scene.
    pub(crate) files: Vec<PathBuf>,
    /// The frames that have pictures, rising, if not all.
    pub(crate) range: Option<Vec<u32>>,
    /// Numbers without a file, which show the frame before.
    pub(crate) held: Vec<u32>,
    white: Option<Nits>,
}

impl Scene {
    /// Opens what `[input]` names. Only headers are read.
    pub fn open(config: &Config) -> Result<Scene> {
        if config.has_field() {
            let (footage, edges) = config.field()?;
            let frames = schedule::of_field(config, &edges, footage.len())?;
            let view = view_of(config, None)?;
            return Scene::of(config, Box::new(footage), frames, Default::default(), view);
        }
        let Some(sequence) = config.sequence()? else {
            let footage = Box::new(config.scene());
            let frames = schedule::of_still(config)?;
            let view = View { horizontal_fov_deg: builtin::FIELD_DEG, ..View::default() };
            return Scene::of(config, footage, frames, Default::default(), view);
        };
        let footage = footage_of(config, &sequence.files)?;
        apply_to(config, &*footage)?;
        let sequence = sequence
            .of_film(footage.len())
            .map_err(|problem| config.wrong("input.range", problem))?;
        let frames = if sequence.is_still {
            schedule::of_still(config)?
        } else {
            schedule::of_sequence(
                config,
                &sequence.numbers,
                &sequence.shows,
                footage.header().frames_per_second,
                footage.times(),
            )?
        };
        let view = view_of(config, footage.header().view)?;
        Scene::of(config, footage, frames, (sequence.files, sequence.held), view)
    }

    fn of(
        config: &Config,
        footage: Box<dyn Footage>,
        frames: Vec<Step>,
        (files, held): (Vec<PathBuf>, Vec<u32>),
        view: View,
    ) -> Result<Scene> {
        let steps = schedule::looks(config, &frames)?;
        let range = range_of(config, &steps)?;
        let header = footage.header();
        let pixels_per_degree = view.pixels_per_degree(footage.window().size[0]);
        let mut white = None;
        let vision = match &header.kind {
            Kind::Spectral(bands) => Vision::of_bands(config.observer(), bands),
            Kind::Rgb(primaries) => {
                white = Some(white_of(config, header)?);
                let vision =
                    Vision::of_rgb(config.observer(), primaries, white.unwrap_or_default());
                vision.ok_or_else(|| {
                    config.wrong("input.frames", "the file's chromaticities span no gamut")
                })?
            }
        };
        Ok(Scene { pixels_per_degree, vision, frames, steps, files, range, held, white, footage })
    }

    /// The eye of `[observer]`, `[numerics]` and `[gaze]` before its first look.
    pub fn eye(&self, config: &Config) -> Result<Eye> {
        let header = self.footage.header();
        let size = [header.width, header.height];
        let across = Degrees(header.width as f64 / self.pixels_per_degree);
        eye_for(config, self.vision.clone(), size, across)
    }

    /// The steps that have pictures.
    pub(crate) fn pictured(&self) -> Vec<Step> {
        let within = |step: &&Step| {
            self.range.as_ref().is_none_or(|range| range.binary_search(&step.number).is_ok())
        };
        self.steps.iter().filter(within).copied().collect()
    }

    /// The footage for the reader. `places`: those to check; `None`: such as the first frame
    /// suggests.
    pub(crate) fn sequence(&self, places: Option<Vec<[usize; 2]>>) -> Sequence<'_> {
        let files = &self.files;
        let (footage, vision, pixels_per_degree) =
            (&*self.footage, &self.vision, self.pixels_per_degree);
        Sequence { footage, files, vision, pixels_per_degree, places }
    }

    /// What the percept's files say of themselves.
    pub(crate) fn about(&self, digest: &str) -> About {
        let header = self.footage.header();
        let (primaries, white) = match &header.kind {
            Kind::Rgb(primaries) => (*primaries, self.white),
            Kind::Spectral(_) => (Primaries::REC709, Some(Nits(1.0))),
        };
        let made_by = serde_json::json!({ "made_by": concat!("sungaze ", env!("CARGO_PKG_VERSION")), "config": digest });
        About {
            primaries: Some(primaries),
            white,
            frames_per_second: schedule::rate(&self.steps),
            sungaze: Some(made_by.to_string()),
        }
    }
}

/// The footage of files, reduced to the width that is asked for. Reduced frames are seen without
/// their overscan.
fn footage_of(config: &Config, files: &[PathBuf]) -> Result<Box<dyn Footage>> {
    let options = config.read_options()?;
    let footage = frames::open(files, &options)?;
    let width = config.settings.input.width.map(|width| width as usize);
    match width.filter(|width| footage.header().width > *width) {
        None => Ok(footage),
        Some(width) => {
            let options = ReadOptions { overscan: Overscan::None, ..options };
            Ok(frames::no_wider(frames::open(files, &options)?, width))
        }
    }
}

/// What the picture shows of the world: the configuration's word, or else the file's.
fn view_of(config: &Config, of_file: Option<View>) -> Result<View> {
    let input = &config.settings.input;
    let Some(horizontal_fov_deg) =
        input.horizontal_fov_deg.or(of_file.map(|view| view.horizontal_fov_deg))
    else {
        let problem = "is required with input.frames that have no VIEW: how many degrees the \
                       picture is across";
        return Err(config.wrong("input.horizontal_fov_deg", problem));
    };
    let of_file = of_file.unwrap_or_default().projection;
    let view = View { horizontal_fov_deg, projection: input.projection.unwrap_or(of_file) };
    view.possible().ok_or_else(|| {
        let problem = format!(
            "found {horizontal_fov_deg}; a perspective picture is less than 180 degrees across"
        );
        config.wrong("input.horizontal_fov_deg", problem)
    })
}

/// The numbers of `output.range`, some of which must be those of frames.
fn range_of(config: &Config, steps: &[Step]) -> Result<Option<Vec<u32>>> {
    let written = &config.settings.output.range;
    if written.is_empty() {
        return Ok(None);
    }
    let wrong = |problem: String| config.wrong("output.range", problem);
    let range = frames::parse_range(written).map_err(wrong)?;
    let mut numbers = steps.iter().map(|step| step.number);
    if numbers.any(|number| range.binary_search(&number).is_ok()) {
        return Ok(Some(range));
    }
    let ends = steps.first().zip(steps.last()).map_or((0, 0), |(a, b)| (a.number, b.number));
    let (first, last) = ends;
    Err(wrong(format!("found {written}, but the frames are {first} to {last}")))
}

/// The eye of `[observer]`, `[numerics]` and `[gaze]` for frames of `size` (width, height) that are
/// `across` degrees wide, wherever they come from.
///
/// # Errors
/// A size or a scale is not above 0, or `observer.start` names no state of that size.
pub fn eye_for(config: &Config, vision: Vision, size: [usize; 2], across: Degrees) -> Result<Eye> {
    keeps_its_budget(config, &vision)?;
    fits_memory(config, &vision, size)?;
    let (scatter, degrees) = (config.scatter(), across.0 / size[0].max(1) as f64);
    let budget = config.settings.numerics.light_budget;
    let optics = Optics::new(&scatter, size, degrees, vision.plane_count(), budget)
        .map_err(|problem| config.wrong("optics.straylight", problem))?;
    let eye = Eye::builder(vision, size, across)
        .pigments(config.pigments())
        .model(config.model()?, config.budget())
        .optics(optics, config.settings.optics.draw)
        .surround(config.settings.gaze.surround_cd_m2);
    let eye = match config.settings.observer.start.as_str() {
        "rested" => eye,
        "adapted" => eye.adapted(),
        file => eye.retina(retina_of_file(config, file, size[0], size[1]).map_err(|e| {
            let problem = format!("{e}; accepted: rested, adapted, or a state file");
            config.wrong("observer.start", problem)
        })?),
    };
    eye.build()
}

/// Refuses keys that mean nothing to frames of this kind.
fn apply_to(config: &Config, footage: &dyn Footage) -> Result<()> {
    let (coded, film) = (footage.header().transfer.is_some(), footage.times().is_some());
    let (input, silent) = (&config.settings.input, Input::default());
    let linear = "frames made for a display; these hold linear light, whose white is \
                  input.white_cd_m2";
    let still = "a film; these frames are none";
    let keys = [
        ("input.transfer", coded || input.transfer == silent.transfer, linear),
        ("input.peak_cd_m2", coded || input.peak_cd_m2.is_none(), linear),
        ("input.matrix", film || input.matrix == silent.matrix, still),
        ("input.code_range", film || input.code_range == silent.code_range, still),
    ];
    match keys.iter().find(|(_, fits, _)| !fits) {
        Some((key, _, what)) => Err(config.wrong(key, format!("belongs to {what}"))),
        None => Ok(()),
    }
}

/// Refuses a luminance of (1, 1, 1) that the frames' curve tells itself, or in other words.
fn suits(config: &Config, transfer: Transfer) -> Result<()> {
    let input = &config.settings.input;
    let (white, peak) = ("input.white_cd_m2", "input.peak_cd_m2");
    let wrong = |key: &str, problem: &str| Err(config.wrong(key, problem));
    match (transfer, input.white_cd_m2, input.peak_cd_m2) {
        (Transfer::Pq, Some(_), _) => wrong(white, "PQ tells its light in cd/m2: leave it out"),
        (Transfer::Pq, _, Some(_)) => wrong(peak, "PQ tells its light in cd/m2: leave it out"),
        (Transfer::Hlg(_), Some(_), _) => {
            wrong(white, "the light of HLG is its display's: say input.peak_cd_m2 instead")
        }
        (Transfer::Hlg(None), ..) => {
            wrong(peak, "is required for HLG, whose light is its display's; the reference is 1000")
        }
        (Transfer::Linear, _, Some(_)) => {
            wrong(peak, "linear light has no display: say input.white_cd_m2 instead")
        }
        (_, Some(_), Some(_)) => wrong(peak, "says the same as input.white_cd_m2: give one"),
        _ => Ok(()),
    }
}

/// Refuses frames whose eye would not fit into the memory that is free: pigment, two frames of
/// halves, three percepts of halves and two display pictures, and the planes of the optics.
fn fits_memory(config: &Config, vision: &Vision, size: [usize; 2]) -> Result<()> {
    let planes = vision.plane_count() as u64;
    let scattered = if config.scatter().psf == Psf::None { 0 } else { 2 * 4 * planes };
    let of_pixel = 3 * 8 + 2 * 2 * planes + 3 * 6 + 2 * 3 + scattered;
    let pixels = size.iter().fold(1u64, |pixels, n| pixels.saturating_mul(*n as u64));
    let what = format!("an eye for frames of {} x {} pixels", size[0], size[1]);
    frames::memory::must_hold(&what, pixels.saturating_mul(of_pixel)).map_err(Error::light)
}

/// Refuses a budget below the default's that no plan can keep. The default itself is promised to all
/// light that it can be kept for; a plan says what it promises to the rest.
fn keeps_its_budget(config: &Config, vision: &Vision) -> Result<()> {
    let Some(budget) = config.budget().filter(|budget| *budget < plan::BUDGET) else {
        return Ok(());
    };
    let least = plan::least_budget(vision);
    if least <= budget {
        return Ok(());
    }
    let accepted = format!("{:.1e} to 1", 1.05 * least);
    let problem = format!(
        "found {budget:e}, less than reading pigment at a few levels and single precision keep; \
         accepted: {accepted}; numerics.model = \"tracked\" promises no bound"
    );
    Err(config.wrong("numerics.budget", problem))
}

/// Luminance of (1, 1, 1): the configuration's, or else the file's. Never guessed.
fn white_of(config: &Config, header: &Header) -> Result<Nits> {
    header.transfer.map_or(Ok(()), |transfer| suits(config, transfer))?;
    config.settings.input.white_cd_m2.map(Nits).or(header.white).ok_or_else(|| {
        let problem = "is required for RGB frames that do not say it: the luminance of (1, 1, 1) \
                       in cd/m2. Usual are 100 for a picture made for a display, 72983 for \
                       Mitsuba's hdrfilm, 179 for Radiance; for a film say peak_cd_m2, its display's";
        config.wrong("input.white_cd_m2", problem)
    })
}
