//! A live eye: it lives look by look, remembers its path, and can go back along it.
//!
//! The path is all that it was: the end and the gaze of every look. The same path under the same
//! configuration gives the same pictures, bit for bit, so going back is living again from a key
//! frame, and a changed observer lives the same path once more.

use std::borrow::Cow;
use std::sync::Arc;

use serde_json::Value;

use super::keys::Keys;
use super::message::Head;
use super::painter::Picture;
use super::reel::Reel;
use crate::config::Config;
use crate::display::{Display, ToneMap};
use crate::error::Result;
use crate::eye::{self, Eye, Look, Stimulus};
use crate::light::Planes;
use crate::run::gaze::{self, Gaze};
use crate::run::schedule::Step;
use crate::run::{Loaded, Scene, record};
use crate::units::Seconds;

/// One look of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The end of the look, s.
    pub end: f64,
    /// Fractions of the picture.
    pub(crate) gaze: [f64; 2],
    /// Unbleached fractions at the gaze, once lived.
    pub(crate) p: [f32; 3],
}

/// What the next picture depends on.
#[derive(Clone)]
struct Seen {
    eye: eye::State,
    map: Arc<ToneMap>,
}

/// An eye in front of its footage, and the path that it has lived.
pub struct Live {
    config: Config,
    scene: Scene,
    reel: Reel,
    loaded: (usize, Loaded),
    display: Display,
    map: Arc<ToneMap>,
    eye: Eye,
    /// The last look, without its percept.
    look: Look,
    /// The light itself, as an eye sees it that nothing has bleached.
    before: Arc<Planes>,
    percept: Arc<Planes>,
    head: Head,
    path: Vec<Moment>,
    /// How many looks of the path have been lived, and how many are to be.
    lived: usize,
    target: usize,
    keys: Keys<Seen>,
    spare: Option<Planes>,
}

impl Live {
    /// Opens what a configuration names, with a rested eye that looks where `[gaze]` says; one that
    /// was saved has a path still to be lived.
    ///
    /// # Errors
    /// Those of a run: a wrong key, a frame that cannot be read.
    pub fn open(config: Config) -> Result<Live> {
        let scene = Scene::open(&config)?;
        let saved = config.settings.time.follows_the_gaze();
        let still = scene.footage.len() == 1;
        let reel = Reel::new(&scene.frames, still);
        let first = reel.file(0.0);
        let loaded = scene.sequence(Some(Vec::new())).load(first, None)?;
        let display = config.display();
        let eye = scene.eye(&config)?;
        let (look, before) = parted(unbleached(&config, &scene, &loaded)?);
        let map = Arc::new(display.follow(None, &look.survey, Seconds(0.0)));
        let before = Arc::new(before);
        let gaze = first_gaze(&config, &scene, &loaded)?;
        let head = Head::rested(scene.footage.window().size, gaze);
        let path = if saved { recorded(&config)? } else { Vec::new() };
        Ok(Live {
            keys: Keys::new(Seen { eye: eye.state(), map: map.clone() }),
            percept: before.clone(),
            lived: 0,
            target: path.len(),
            spare: None,
            config,
            scene,
            reel,
            loaded: (first, loaded),
            display,
            map,
            eye,
            look,
            before,
            head,
            path,
        })
    }

    /// The configuration under which the eye lives.
    pub(crate) fn config(&self) -> &Config {
        &self.config
    }

    /// The moment up to which the eye has lived, s.
    pub fn now(&self) -> f64 {
        self.lived.checked_sub(1).map_or(0.0, |last| self.path[last].end)
    }

    /// The configuration of a run that follows this path, beside it in a file of this name.
    ///
    /// # Errors
    /// A configuration that TOML cannot hold: never.
    pub(crate) fn viewing(&self, path: &str) -> Result<String> {
        self.config.viewing(path, self.reel.is_still())
    }

    /// What the reader passed over, assumed or did, one sentence each.
    pub(crate) fn notes(&self) -> &[String] {
        &self.scene.footage.header().notes
    }

    /// The path, as far as it is known.
    pub fn path(&self) -> &[Moment] {
        &self.path
    }

    /// Where the eye looks, fractions of the picture.
    pub(crate) fn gaze(&self) -> [f64; 2] {
        self.head.gaze
    }

    /// Whether looks of the path are still to be lived.
    pub fn is_behind(&self) -> bool {
        self.lived < self.target
    }

    /// Looks at a point until `end`, or until the frame in front of the eye ends. What was known of
    /// later looks is forgotten. Returns whether there was anything left to look at.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn look(&mut self, gaze: [f64; 2], end: f64) -> Result<bool> {
        let Some(end) = self.reel.until(self.now(), end) else { return Ok(false) };
        self.path.truncate(self.lived);
        self.keys.forget_after(self.lived);
        self.path.push(Moment { end, gaze, p: [1.0; 3] });
        self.target = self.path.len();
        self.live_on().map(|()| true)
    }

    /// Goes to a moment of the path: what is still to be lived for it is left to [`Live::live_on`].
    ///
    /// # Errors
    /// A key frame that does not fit this eye: never.
    pub fn go_to(&mut self, time: f64) -> Result<()> {
        self.target = self.path.partition_point(|moment| moment.end <= time);
        let (back, last) = (self.target < self.lived, self.target.saturating_sub(1));
        if back || self.keys.nearest(last) > self.lived {
            // A state has no percept: at least one look is lived anew, but for the start.
            self.go_back_to(last)?;
        }
        Ok(())
    }

    /// Where the eye will look once it has caught up, fractions of the picture.
    pub(crate) fn gaze_to_come(&self) -> [f64; 2] {
        self.target.checked_sub(1).map_or(self.head.gaze, |last| self.path[last].gaze)
    }

    /// Starts again with a rested eye; nothing is left of the path.
    ///
    /// # Errors
    /// A key frame that does not fit this eye: never.
    pub fn rest(&mut self) -> Result<()> {
        self.path.clear();
        self.keys.forget_after(0);
        self.target = 0;
        self.go_back_to(0)
    }

    /// Goes back to the last key frame at or before this many looks.
    fn go_back_to(&mut self, looks: usize) -> Result<()> {
        let (at, Seen { eye, map }) = self.keys.before(looks);
        self.eye.restore(eye)?;
        self.map = map;
        self.lived = at;
        if at == 0 {
            self.percept = self.before.clone();
            self.head = Head::rested(self.head.size, self.head.gaze);
        }
        Ok(())
    }

    /// Lives the next look of the path.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn live_on(&mut self) -> Result<()> {
        let (start, Moment { end, gaze, .. }) = (self.now(), self.path[self.lived]);
        let duration = end - start;
        self.load(self.reel.file(start))?;
        let light = &self.loaded.1;
        let at = self.scene.footage.window().pixel(gaze);
        if let Some(spare) = self.spare.take() {
            self.eye.recycle(spare);
        }
        let (look, percept) = parted(self.eye.look_at(stimulus(light), at, Seconds(duration)));
        self.map = Arc::new(self.display.follow(Some(&self.map), &look.survey, Seconds(duration)));
        let pixel = record::nearest(at, [percept.width, percept.height]);
        let p = self.eye.fractions_at(&look, pixel);
        self.head = Head { time: end, duration, p, gaze, ..self.head };
        (self.head.pupil_mm, self.head.fovea) = (look.pupil.0, look.adapting.0);
        self.path[self.lived].p = p.map(|p| p as f32);
        (self.look, self.percept) = (look, Arc::new(percept));
        self.lived += 1;
        let size = 8 * self.eye.retina().fractions().len();
        let seen = || Seen { eye: self.eye.state(), map: self.map.clone() };
        self.keys.keep(self.lived, size, seen);
        Ok(())
    }

    fn load(&mut self, file: usize) -> Result<()> {
        if self.loaded.0 != file {
            self.loaded = (file, self.scene.sequence(Some(Vec::new())).load(file, None)?);
            self.before = Arc::new(unbleached(&self.config, &self.scene, &self.loaded.1)?.percept);
        }
        Ok(())
    }

    /// Takes a percept back to be written over.
    pub(crate) fn recycle(&mut self, picture: Picture) {
        self.spare = Arc::into_inner(picture.percept).or(self.spare.take());
    }

    /// The last look as it is to be shown, or the light that was looked at before anything bleached.
    pub fn picture(&self, before: bool) -> Picture {
        Picture {
            head: self.head,
            lasts: true,
            percept: self.shown(if before { &self.before } else { &self.percept }),
            to_srgb: self.scene.vision.seen_to_srgb.map(|row| row.map(|v| v as f32)),
            display: self.display,
            map: self.map.clone(),
        }
    }

    /// The part of a percept that a display shows.
    fn shown(&self, percept: &Arc<Planes>) -> Arc<Planes> {
        match self.scene.footage.window().of(percept) {
            Cow::Borrowed(_) => percept.clone(),
            Cow::Owned(shown) => Arc::new(shown),
        }
    }

    /// The row that `trace.csv` of a run has for the last look; `None` before the first.
    pub fn trace(&self) -> Option<String> {
        let last = self.lived.checked_sub(1)?;
        let start = last.checked_sub(1).map_or(0.0, |i| self.path[i].end);
        let end = self.path[last].end;
        let step = Step { number: self.lived as u32, file: self.loaded.0, start, end };
        let (planes, window) = (&self.loaded.1.frame.planes, self.scene.footage.window());
        Some(record::trace_row(&self.eye, planes, window, &self.look, &step))
    }

    /// Sets keys of the configuration, of which null is the default. Other displays show the last
    /// look anew; another observer has the whole path to live again.
    ///
    /// # Errors
    /// A value that the configuration refuses; then all is as it was.
    pub fn set(&mut self, keys: &[(String, Value)]) -> Result<()> {
        let config = self.config.with_values(keys)?;
        if keys.iter().all(|(key, _)| key.starts_with("display.")) && self.reel.is_still() {
            self.config = config;
            self.display = self.config.display();
            self.map = Arc::new(self.display.follow(None, &self.look.survey, Seconds(0.0)));
            self.keys.each(|state| state.map = self.map.clone());
            return Ok(());
        }
        let mut other = Live::open(config)?;
        other.path = std::mem::take(&mut self.path);
        other.target = self.target;
        other.head.gaze = self.head.gaze;
        *self = other;
        Ok(())
    }
}

/// The path that a configuration names, still to be lived.
fn recorded(config: &Config) -> Result<Vec<Moment>> {
    let rows = Gaze::of(config)?.rows();
    Ok(rows.iter().map(|&(end, gaze)| Moment { end, gaze, p: [1.0; 3] }).collect())
}

/// Where the eye looks at first, fractions of the picture.
fn first_gaze(config: &Config, scene: &Scene, light: &Loaded) -> Result<[f64; 2]> {
    let window = scene.footage.window();
    let brightest = || eye::brightest(&scene.vision, &light.frame.planes, &light.survey);
    let first = gaze::Moment { time: 0.0, frame: 0 };
    let at = Gaze::of(config)?.pixel(first, brightest, window, None);
    Ok(window.fraction(at).map(|at| at.clamp(0.0, 1.0)))
}

/// A look and its percept, each by itself.
fn parted(mut look: Look) -> (Look, Planes) {
    let percept = std::mem::replace(&mut look.percept, Planes::float(0, 0, 0));
    (look, percept)
}

/// The look of an eye that nothing bleaches.
fn unbleached(config: &Config, scene: &Scene, light: &Loaded) -> Result<Look> {
    let config = config.with_values(&[("numerics.model".into(), "none".into())])?;
    let mut eye = scene.eye(&config)?;
    Ok(eye.look_at(stimulus(light), [0.0; 2], Seconds(0.0)))
}

/// A frame, nothing of which is checked.
fn stimulus(light: &Loaded) -> Stimulus<'_> {
    Stimulus {
        planes: &light.frame.planes,
        survey: &light.survey,
        checked: &[],
        spectra: None,
        uniform: light.uniform.as_deref(),
    }
}
