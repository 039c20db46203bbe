//! The eye's thread: wishes are heeded, time is lived, pictures are shown.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::exchange::Exchange;
use super::live::Live;
use super::message::Wish;
use super::painter::Picture;
use super::saved;
use crate::error::Result;

/// Time between two looks at least.
const TICK: Duration = Duration::from_millis(15);
/// The eye's time is counted in these parts of a second, so that every edge of a look is exact in binary and short in
/// decimal.
const GRAIN: f64 = 1024.0;
/// The most wall time that one look stands for: a slow machine takes longer looks, a stopped one does not leap.
const LONGEST: Duration = Duration::from_millis(250);
/// A path that is lived again is shown so often.
const GLIMPSE: Duration = Duration::from_millis(60);
/// The most rows of a history that a page is sent.
const ROWS: usize = 2000;

/// A live eye as one page wants it to live.
pub(crate) struct Pace {
    live: Live,
    /// Where it is saved.
    out: PathBuf,
    playing: bool,
    speed: f64,
    gaze: [f64; 2],
    id: u32,
    before: bool,
    /// When time was last taken from the wall clock, and a picture last shown.
    clock: Instant,
    shown: Instant,
}

impl Pace {
    pub(crate) fn new(live: Live, out: PathBuf) -> Self {
        let (gaze, now) = (live.gaze(), Instant::now());
        let (playing, speed, id, before) = (false, 1.0, 0, false);
        Pace { live, out, playing, speed, gaze, id, before, clock: now, shown: now }
    }

    /// Lives until the exchange is closed.
    pub(crate) fn live(mut self, exchange: &Exchange<Picture>) {
        self.tell(exchange);
        self.show(exchange);
        while let Some(wish) = exchange.heed(self.is_at_rest()) {
            let wanted = !wish.is_empty();
            let heeded = self.heed(wish, exchange);
            if let Err(error) = heeded.and_then(|()| self.step(wanted, exchange)) {
                self.playing = false;
                exchange.say("note", error.to_string().into());
                self.show(exchange);
            }
        }
    }

    /// Whether there is nothing to live.
    fn is_at_rest(&self) -> bool {
        !(self.playing || self.live.is_behind() || self.has_moved())
    }

    /// Whether the eye is to look elsewhere.
    fn has_moved(&self) -> bool {
        self.gaze != self.live.gaze()
    }

    /// Heeds a wish: first how to live, then what to do.
    fn heed(&mut self, wish: Wish, exchange: &Exchange<Picture>) -> Result<()> {
        if wish.play == Some(true) && !self.playing {
            self.clock = Instant::now();
        }
        self.gaze = wish.look.unwrap_or(self.gaze);
        self.id = self.id.max(wish.id);
        self.playing = wish.play.unwrap_or(self.playing);
        self.speed = wish.speed.unwrap_or(self.speed);
        self.before = wish.before.unwrap_or(self.before);
        if wish.hello {
            self.tell(exchange);
        }
        if !wish.set.is_empty() {
            self.live.set(&wish.set.into_iter().collect::<Vec<_>>())?;
            self.tell(exchange);
        }
        if let Some(time) = wish.scrub {
            self.playing = false;
            self.live.go_to(time)?;
            self.gaze = self.live.gaze_to_come();
        }
        if wish.rest {
            self.live.rest()?;
            self.gaze = self.live.gaze();
            exchange.say("history", json!([]));
        }
        if wish.save {
            self.save(exchange)?;
        }
        wish.open.map_or(Ok(()), |name| self.open(&name, exchange))
    }

    fn save(&self, exchange: &Exchange<Picture>) -> Result<()> {
        let (name, looks) = (saved::save(&self.live, &self.out)?, self.live.path().len());
        let names = saved::names(&self.out);
        let saved = json!({ "name": name, "folder": self.out, "looks": looks, "names": names });
        exchange.say("saved", saved);
        Ok(())
    }

    fn open(&mut self, name: &str, exchange: &Exchange<Picture>) -> Result<()> {
        let live = Live::open(saved::open(&self.out, name)?)?;
        *self = Pace { id: self.id, ..Pace::new(live, self.out.clone()) };
        self.gaze = self.live.gaze_to_come();
        self.tell(exchange);
        Ok(())
    }

    /// One step: a look of the path that is still to be lived, or a new one.
    fn step(&mut self, wanted: bool, exchange: &Exchange<Picture>) -> Result<()> {
        if self.live.is_behind() {
            self.live.live_on()?;
            self.clock = Instant::now();
            if self.live.is_behind() && self.shown.elapsed() < GLIMPSE {
                return Ok(());
            }
            if !self.live.is_behind() {
                exchange.say("history", self.history());
            }
        } else if self.playing || self.has_moved() {
            self.look(exchange)?;
        } else if !wanted {
            return Ok(());
        }
        self.show(exchange);
        Ok(())
    }

    /// A new look at the next tick; at rest, a glance. A sequence takes a look for each frame: where
    /// they are more than can be shown, pictures are passed over, not time.
    fn look(&mut self, exchange: &Exchange<Picture>) -> Result<()> {
        self.wait();
        let (begun, known) = (Instant::now(), self.live.path().len());
        let end = self.live.now() + self.elapsed();
        while self.live.now() < end && begun.elapsed() < LONGEST {
            if !self.live.look(self.gaze, end)? {
                // A sequence is over.
                (self.playing, self.gaze) = (false, self.live.gaze());
                break;
            }
        }
        if self.live.path().len() <= known {
            // It had gone back: what came later is no more.
            exchange.say("history", self.history());
        }
        Ok(())
    }

    /// Waits for the next tick.
    fn wait(&self) {
        std::thread::sleep(TICK.saturating_sub(self.clock.elapsed()));
    }

    /// How long the next look lasts, s of the eye's time: at rest, a glance.
    fn elapsed(&mut self) -> f64 {
        let wall = self.clock.elapsed().min(LONGEST).as_secs_f64();
        self.clock = Instant::now();
        let time = if self.playing { self.speed * wall } else { 0.0 };
        (time * GRAIN).round().max(1.0) / GRAIN
    }

    fn show(&mut self, exchange: &Exchange<Picture>) {
        let mut picture = self.live.picture(self.before);
        picture.head.id = self.id;
        picture.head.playing = self.playing;
        picture.lasts = self.is_at_rest();
        self.shown = Instant::now();
        if let Some(old) = exchange.show(picture) {
            self.live.recycle(old);
        }
    }

    /// Tells the page what there is: settings, saved viewings, the history so far.
    fn tell(&self, exchange: &Exchange<Picture>) {
        let settings = crate::run::resolved(&self.live.config().settings);
        let constants: Vec<_> = crate::constants::CONSTANTS.iter().map(|set| set.name).collect();
        let names = saved::names(&self.out);
        let title = &self.live.config().name;
        exchange.say(
            "settings",
            json!({ "config": settings, "constants": constants, "names": names, "title": title, "notes": self.live.notes() }),
        );
        exchange.say("history", self.history());
    }

    /// Time and p at the gaze of every look that is known, thinned.
    fn history(&self) -> Value {
        let path = self.live.path();
        let stride = path.len().div_ceil(ROWS).max(1);
        let row = |m: &super::live::Moment| json!([m.end, m.p[0], m.p[1], m.p[2]]);
        path.iter().rev().step_by(stride).rev().map(row).collect()
    }
}
