//! `report.json`: what was run, with which constants, what was left out, what went wrong, and how
//! long it took.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::config::Config;
use crate::constants;
use crate::eye::LookStats;
use crate::light::Tally;
use crate::observer::CONES;

/// What a run has met so far; part of a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Counters {
    /// What was wrong with samples, over all frames.
    pub(crate) tally: Tally,
    /// Frames with NaN or Inf that a policy let go on.
    pub(crate) mended_frames: Vec<u32>,
    /// Frames that had no file and showed the one before.
    pub(crate) held_frames: Vec<u32>,
    /// Percept samples beyond what a half float holds.
    pub(crate) limited: u64,
    /// First time, s, and greatest share of the retina with more than half of its S pigment
    /// bleached.
    pub(crate) s_past_half_from_s: Option<f64>,
    pub(crate) s_past_half_share: f64,
    /// First frame that took a method past its limit: its message.
    pub(crate) method_past_limit: Option<String>,
}

impl Counters {
    /// Adds what was wrong with one frame's samples.
    pub(crate) fn count(&mut self, frame: u32, tally: Tally) {
        self.tally = self.tally.plus(tally);
        if tally.non_finite() > 0 {
            self.mended_frames.push(frame);
        }
    }

    /// Adds what one look met. `places`: how many the retina has.
    pub(crate) fn meet(&mut self, time: f64, stats: &LookStats, places: usize) {
        self.limited += stats.limited;
        if stats.s_past_half > 0 {
            self.s_past_half_from_s.get_or_insert(time);
            self.s_past_half_share =
                self.s_past_half_share.max(stats.s_past_half as f64 / places as f64);
        }
    }

    /// Whether some frames were bad and a policy let the run go on.
    pub(crate) fn went_on(&self) -> bool {
        !(self.mended_frames.is_empty() && self.held_frames.is_empty())
    }

    /// One sentence on bad frames; `None` if there were none.
    fn bad_frames(&self) -> Option<String> {
        let mut parts = Vec::new();
        if !self.mended_frames.is_empty() {
            let (nan, infinite) = (self.tally.nan, self.tally.infinite);
            parts.push(format!(
                "{nan} NaN and {infinite} infinite samples replaced in {}",
                frames(&self.mended_frames)
            ));
        }
        if !self.held_frames.is_empty() {
            parts.push(format!(
                "no file for {}: the frame before was held",
                frames(&self.held_frames)
            ));
        }
        if self.tally.negative > 0 {
            parts.push(format!("{} negative samples met", self.tally.negative));
        }
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    /// Every warning, one sentence each.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut warnings: Vec<String> = self.bad_frames().into_iter().collect();
        if self.tally.clipped > 0 {
            warnings.push(format!(
                "{} samples stand at the top of a display-referred picture: the light there, such as the sun, is cut off",
                self.tally.clipped
            ));
        }
        if self.limited > 0 {
            warnings.push(format!(
                "{} samples of the percept were limited to the largest half float, 65504",
                self.limited
            ));
        }
        if let Some(time) = self.s_past_half_from_s {
            let percent = 100.0 * self.s_past_half_share;
            let share = if percent < 0.01 {
                "less than 0.01".into()
            } else {
                format!("up to {percent:.2}")
            };
            warnings.push(format!(
                "S cones lost more than half of their pigment from {time:.3} s on, over {share} % of the retina; \
                 such bleaching can impair them for long"
            ));
        }
        warnings.extend(self.method_past_limit.clone());
        warnings
    }
}

/// Seconds spent, in all pieces of a run that was resumed; part of a checkpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Timing {
    pub(crate) decode_s: f64,
    pub(crate) simulate_s: f64,
    pub(crate) display_s: f64,
    pub(crate) encode_s: f64,
    pub(crate) wall_s: f64,
}

impl Timing {
    /// The seconds, and what they were spent on.
    pub(crate) fn report(&self) -> Value {
        let mut report = serde_json::to_value(self).unwrap_or_default();
        report["threads"] = rayon::current_num_threads().into();
        report["processor"] = processor().into();
        report
    }

    /// Adds what another stage has spent.
    pub(crate) fn add(&mut self, other: &Timing) {
        self.decode_s += other.decode_s;
        self.simulate_s += other.simulate_s;
        self.display_s += other.display_s;
        self.encode_s += other.encode_s;
        self.wall_s += other.wall_s;
    }
}

/// The processor's own name where the system tells it, else the architecture and system.
pub(crate) fn processor() -> String {
    let told = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    told.unwrap_or_else(|| format!("{} {}", std::env::consts::ARCH, std::env::consts::OS))
}

/// The `check` of a run whose model was asked for and is not meant to be true: nothing was
/// compared.
pub(crate) fn unchecked() -> Value {
    json!({ "samples": 0, "max_error_p": null, "max_error_catch": null })
}

fn frames(numbers: &[u32]) -> String {
    match numbers {
        [one] => format!("frame {one}"),
        [first, .., last] => format!("{} frames ({first} to {last})", numbers.len()),
        [] => "no frame".into(),
    }
}

/// The constants in force and where they come from.
pub(crate) fn constants(config: &Config) -> Value {
    let o = &config.settings.observer;
    let set = constants::named(&o.constants);
    let as_published =
        set.is_some_and(|s| s.half_bleach_log_td == o.half_bleach_log_td && s.tau_s == o.tau_s);
    json!({
        "set": o.constants,
        "source": if as_published { set.map_or("", |s| s.source) } else { "given in the configuration" },
        "law": config.pigments()[0].law.formula(),
        "cones": CONES,
        "half_bleach_td": o.half_bleach_log_td.map(|log| 10f64.powf(log)),
        "tau_s": o.tau_s,
        "kinetics": o.kinetics.name(),
        "km": o.km,
        "optical_density": o.optical_density,
        "fundamentals": match o.fundamentals {
            crate::observer::Set::Cie2006 => "CIE 170-1:2006, Stockman & Sharpe 2000",
            crate::observer::Set::Smj1993 => "Stockman, MacLeod & Johnson 1993",
        },
        "lms_to_xyz": "CIE 170-2:2015, or the inverse of the 1993 set's matrix",
        "rgb_basis": "Mallett & Yuksel 2019 under CIE D65",
    })
}

/// The first line of a table whose reader asks for the law (`output.law`): a comment.
pub(crate) fn law_line(config: &Config) -> String {
    if !config.settings.output.law {
        return String::new();
    }
    let [law, set, source, light, tau, km, density] =
        ["law", "set", "source", "half_bleach_td", "tau_s", "km", "optical_density"]
            .map(|key| constants(config)[key].clone());
    let word = |value: Value| value.as_str().unwrap_or_default().to_owned();
    format!(
        "# {}; of L, M, S: I0 = {light} td, tau = {tau} s, D = {density}; Km = {km}; constants {}: {}\n",
        word(law),
        word(set),
        word(source)
    )
}
