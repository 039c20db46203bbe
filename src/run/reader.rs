//! The first stage of a run: decodes frames ahead of the eye.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::Instant;

use crate::error::{Error, Result};
use crate::eye;
use crate::eye::check;
use crate::frames::Footage;
use crate::light::Survey;
use crate::light::{Frame, Planes};
use crate::run::inputs::Input;
use crate::run::schedule::Step;
use crate::vision::SampledSpectra;
use crate::vision::Vision;

/// A decoded frame and its luminances, on their way to the eye.
pub(crate) struct Loaded {
    pub(crate) frame: Frame,
    /// The file as it was read; none for a built-in scene.
    pub(crate) input: Option<Input>,
    /// How long it took to read, s.
    pub(crate) took_s: f64,
    pub(crate) survey: Arc<Survey>,
    /// The places of the sampled check, and their spectra where frames hold bands.
    pub(crate) places: Arc<Vec<[usize; 2]>>,
    pub(crate) kept: Option<Arc<SampledSpectra>>,
    /// The moments of every place, where all have the same light.
    pub(crate) uniform: Option<Vec<f64>>,
}

/// The footage as the reader sees it.
pub(crate) struct Sequence<'a> {
    pub(crate) footage: &'a dyn Footage,
    /// Its files, one a frame; none for a built-in scene.
    pub files: &'a [PathBuf],
    pub(crate) vision: &'a Vision,
    pub(crate) pixels_per_degree: f64,
    /// The places to check: none, these, or (`None`) such as the first frame suggests.
    pub(crate) places: Option<Vec<[usize; 2]>>,
}

impl Sequence<'_> {
    /// Decodes and surveys one file. The first one of spectral frames is decoded twice if its
    /// places are still to be chosen and its spectra to be kept.
    pub(crate) fn load(&mut self, file: usize, recycled: Option<Planes>) -> Result<Loaded> {
        let projection = self.vision.projection();
        if self.footage.uniform(file).is_some() {
            // Nothing is left out of a uniform field: there is nothing to check.
            self.places = Some(Vec::new());
        }
        if self.places.is_none() {
            let first = self.footage.read(file, projection, recycled)?;
            let places = check::places(self.vision, &first.planes);
            self.places = Some(places.clone());
            return match projection {
                None => self.loaded(file, first, Arc::new(places), None),
                Some(_) => self.load(file, Some(first.planes)),
            };
        }
        let places = Arc::new(self.places.clone().unwrap_or_default());
        let kept = if places.is_empty() { None } else { check::room(self.vision, &places) };
        let keeping = match (projection, &kept) {
            (Some(projection), Some(kept)) => Some(projection.keeping(kept.clone())),
            (projection, _) => projection.cloned(),
        };
        let frame = self.footage.read(file, keeping.as_ref(), recycled)?;
        self.loaded(file, frame, places, kept)
    }

    fn loaded(
        &self,
        file: usize,
        frame: Frame,
        places: Arc<Vec<[usize; 2]>>,
        kept: Option<Arc<SampledSpectra>>,
    ) -> Result<Loaded> {
        let survey = eye::survey(self.vision, &frame.planes, self.pixels_per_degree);
        if !(survey.mean.is_finite() && survey.greatest.is_finite()) {
            let problem =
                "is brighter than 3.4e38 cd/m2 somewhere: check input.white_cd_m2 or input.scale";
            return Err(Error::file(format!("frame file {}", file + 1), problem));
        }
        let (survey, uniform) = (Arc::new(survey), self.footage.uniform(file).map(<[f64]>::to_vec));
        Ok(Loaded { frame, input: None, took_s: 0.0, survey, places, kept, uniform })
    }
}

/// The frames of a sequence in the order of its steps: a file that follows itself is read once.
pub(crate) struct Frames<'a> {
    sequence: Sequence<'a>,
    last: Option<(usize, Arc<Loaded>)>,
}

impl<'a> Frames<'a> {
    pub(crate) fn new(sequence: Sequence<'a>) -> Self {
        Frames { sequence, last: None }
    }

    /// The frame of a step. `spare`: planes to be written over, if there are any by then.
    pub(crate) fn of(
        &mut self,
        step: &Step,
        spare: impl FnOnce() -> Option<Planes>,
    ) -> Result<Arc<Loaded>> {
        if let Some((_, loaded)) = self.last.as_ref().filter(|(file, _)| *file == step.file) {
            return Ok(loaded.clone());
        }
        // Let go of the frame before, so that its planes can come back to be written over.
        let before = self.last.take().and_then(|(_, loaded)| Arc::into_inner(loaded));
        let spare = before.map(|loaded| loaded.frame.planes).or_else(spare);
        let loaded = Arc::new(read(&mut self.sequence, step, spare)?);
        self.last = Some((step.file, loaded.clone()));
        Ok(loaded)
    }
}

/// Reads the frame of every step, until the eye hangs up. `spent` holds planes to be written over.
pub(super) fn read_all(
    sequence: Sequence<'_>,
    steps: &[Step],
    to_eye: &SyncSender<Result<Arc<Loaded>>>,
    spent: &Receiver<Planes>,
) {
    let mut frames = Frames::new(sequence);
    for step in steps {
        let frame = frames.of(step, || spent.try_recv().ok());
        let failed = frame.is_err();
        if to_eye.send(frame).is_err() || failed {
            break;
        }
    }
}

/// Digests and decodes the file of a step.
fn read(sequence: &mut Sequence<'_>, step: &Step, recycled: Option<Planes>) -> Result<Loaded> {
    let begun = Instant::now();
    // A film is one file, which is read with its first frame.
    let film = || sequence.files.first().filter(|_| step.start == 0.0);
    let file = sequence.files.get(step.file).or_else(film);
    let input = file.map(|path| Input::of(path, Some(step.number))).transpose()?;
    let loaded = sequence.load(step.file, recycled)?;
    Ok(Loaded { input, took_s: begun.elapsed().as_secs_f64(), ..loaded })
}
