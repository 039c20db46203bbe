//! `scene = "field"`: its light, and how long each level lasts.

use crate::error::Result;
use crate::frames::uniform::UniformField;
use crate::observer::photometry;
use crate::spectrum::Curve;
use crate::units::Millimetres;

use super::Config;
use super::settings::{Scene, UnitKey};

/// A pupil of 1 mm2, through which one cd/m2 is one troland.
pub(super) const UNIT_PUPIL: Millimetres = Millimetres(std::f64::consts::FRAC_2_SQRT_PI);

/// Header of a light history.
const HISTORY: &str = "time_s,td_L,td_M,td_S";

/// The most frames that a schedule may ask for.
const MOST_FRAMES: usize = 10_000_000;

/// The lights of a field, in order, and when they change.
struct Lights {
    /// Strengths for L, M and S cones.
    strengths: Vec<[f64; 3]>,
    /// Starts of all and the end of the last, s; none for one light that stays.
    edges: Vec<f64>,
}

impl Config {
    /// Whether the scene is a uniform field.
    pub(crate) fn has_field(&self) -> bool {
        self.settings.input.scene == Some(Scene::Field)
    }

    /// Whether light is given in trolands: no pupil, no Stiles-Crawford effect and no lens but
    /// the tabulated observer's are in its way.
    pub(super) fn is_at_the_retina(&self) -> bool {
        self.has_field() && self.settings.input.unit != Some(UnitKey::CdM2)
    }

    /// The uniform field of `[input]`, and the starts of its lights and the end of the last, s;
    /// none for one light that stays. A schedule that is repeated has more starts than lights.
    ///
    /// # Errors
    /// Not one of level, schedule and history is given, a file cannot be read, or keys of the pupil
    /// or the age are given beside trolands.
    pub(crate) fn field(&self) -> Result<(UniformField, Vec<f64>)> {
        self.nothing_before_the_retina()?;
        let Lights { strengths, edges } = self.lights()?;
        let input = &self.settings.input;
        let size = [input.width, input.height].map(|n| n.unwrap_or(16) as usize);
        let strengths = strengths.into_iter();
        let field = UniformField::new(self.observer(), size, &self.spectrum()?, strengths);
        Ok((field, edges))
    }

    fn nothing_before_the_retina(&self) -> Result<()> {
        let keys = [
            "observer.age",
            "observer.pupil",
            "observer.pupil_mm",
            "observer.stiles_crawford",
            "observer.stiles_crawford_p",
        ];
        match keys.iter().find(|key| self.is_at_the_retina() && self.gives(key)) {
            None => Ok(()),
            Some(key) => {
                let problem = "has no meaning for light at the retina: give input.unit = \"cd_m2\"";
                Err(self.wrong(key, problem))
            }
        }
    }

    fn lights(&self) -> Result<Lights> {
        let input = &self.settings.input;
        match (input.level, &input.schedule, &input.history) {
            (Some(level), None, None) => {
                Ok(Lights { strengths: vec![[level; 3]], edges: Vec::new() })
            }
            (None, Some(schedule), None) => self.of_schedule(schedule),
            (None, None, Some(name)) => self.of_history(name),
            _ => {
                let problem = "a field needs one of level, schedule and history";
                Err(self.wrong("input.scene", problem))
            }
        }
    }

    fn of_schedule(&self, schedule: &[[f64; 2]]) -> Result<Lights> {
        let repeat = self.settings.input.repeat.unwrap_or(1) as usize;
        if schedule.len().saturating_mul(repeat) > MOST_FRAMES {
            let problem = format!("asks for more than {MOST_FRAMES} frames");
            return Err(self.wrong("input.repeat", problem));
        }
        let ends = schedule.iter().scan(0.0, |end, &[seconds, _]| {
            *end += seconds;
            Some(*end)
        });
        let ends: Vec<f64> = ends.collect();
        let period = ends.last().copied().unwrap_or_default();
        let later = (0..repeat).flat_map(|i| ends.iter().map(move |end| i as f64 * period + end));
        Ok(Lights {
            strengths: schedule.iter().map(|&[_, level]| [level; 3]).collect(),
            edges: std::iter::once(0.0).chain(later).collect(),
        })
    }

    fn of_history(&self, name: &str) -> Result<Lights> {
        let rows = history_rows(&self.table("input.history", name, HISTORY)?)
            .map_err(|problem| self.wrong("input.history", format!("{name}: {problem}")))?;
        let mut edges: Vec<f64> = rows.iter().map(|row| row[0]).collect();
        if let [.., before, last] = edges[..] {
            edges.push(last + (last - before));
        }
        Ok(Lights { strengths: rows.iter().map(|row| [row[1], row[2], row[3]]).collect(), edges })
    }

    /// The spectrum of the field's light; an equal-energy one for a history, whose cones are given
    /// one by one.
    fn spectrum(&self) -> Result<Curve> {
        match self.settings.input.spectrum.as_deref() {
            None | Some("equal-energy") => Ok(Curve::sampled(|_| 1.0)),
            Some("d65") => Ok(photometry::d65()),
            Some(name) => {
                let accepted = "equal-energy, d65, a CSV of nm,value";
                Curve::of_rows(&self.table("input.spectrum", name, accepted)?)
                    .map_err(|problem| self.wrong("input.spectrum", format!("{name}: {problem}")))
            }
        }
    }

    /// The text of a file that a key names.
    fn table(&self, key: &str, name: &str, accepted: &str) -> Result<String> {
        std::fs::read_to_string(self.path(name))
            .map_err(|e| self.wrong(key, format!("{name:?}: {e}; accepted: {accepted}")))
    }
}

/// Rows of a light history: a time and the illuminance of L, M and S cones, td. The last row lasts
/// as long as the one before.
fn history_rows(text: &str) -> std::result::Result<Vec<[f64; 4]>, String> {
    let lines = text.trim_start_matches('\u{feff}').lines().map(str::trim).enumerate();
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    match lines.next() {
        Some((_, HISTORY)) => {}
        other => {
            let found = other.map(|(_, line)| line).unwrap_or_default();
            return Err(format!("found the header {found:?}; accepted: {HISTORY}"));
        }
    }
    let mut rows: Vec<[f64; 4]> = Vec::new();
    for (i, line) in lines {
        let cells: Vec<f64> = line.split(',').map_while(|cell| cell.trim().parse().ok()).collect();
        let rises = |time: f64| match rows.last() {
            None => time == 0.0,
            Some(last) => time > last[0] && time.is_finite(),
        };
        match cells[..] {
            [time, l, m, s]
                if rises(time) && [l, m, s].iter().all(|td| (0.0..=1e20).contains(td)) =>
            {
                rows.push([time, l, m, s])
            }
            _ => {
                let accepted = "times in s that begin at 0 and rise, and three trolands, 0 to 1e20";
                return Err(format!("line {}: found {line:?}; accepted: {accepted}", i + 1));
            }
        }
    }
    if rows.len() < 2 {
        return Err(format!("found {} rows; accepted: 2 or more", rows.len()));
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_history_that_is_no_history_is_refused_with_its_line() {
        for (text, told) in [
            ("", "header"),
            ("time,L,M,S\n0,1,1,1\n", "td_L"),
            ("time_s,td_L,td_M,td_S\n0,1,1,1\n", "1 rows"),
            ("time_s,td_L,td_M,td_S\n1,1,1,1\n2,1,1,1\n", "line 2"),
            ("time_s,td_L,td_M,td_S\n0,1,1,1\n0,1,1,1\n", "line 3"),
            ("time_s,td_L,td_M,td_S\n0,1,1\n1,1,1,1\n", "line 2"),
            ("time_s,td_L,td_M,td_S\n0,1,1,-1\n1,1,1,1\n", "line 2"),
            ("time_s,td_L,td_M,td_S\n0,1,1,nan\n1,1,1,1\n", "line 2"),
        ] {
            let problem = history_rows(text).unwrap_err();
            assert!(problem.contains(told), "{text:?}: {problem}");
        }
    }
}
