//! Rows of `trace.csv` and `probes.csv`.

use std::io::{BufRead, BufReader};
use std::path::Path;

use serde_json::{Value, json};

use crate::colour::chromaticity;
use crate::config::Config;
use crate::error::{Error, Result};
use crate::eye::{Eye, Look};
use crate::kinetics::Kinetics;
use crate::light::{Planes, Window};
use crate::run::schedule::Step;
use crate::units::Millimetres;

/// Header of `trace.csv`.
pub(crate) const TRACE: &str = "frame,time_s,duration_s,gaze_x,gaze_y,adapting_cd_m2,pupil_mm,sce_L,sce_M,sce_S,\
fovea_bleached_L,fovea_bleached_M,fovea_bleached_S,max_bleached_L,max_bleached_M,max_bleached_S,model\n";

/// Header of `probes.csv`.
pub(crate) const PROBES: &str =
    "frame,time_s,probe,I_L,I_M,I_S,p_L,p_M,p_S,X,Y,Z,x,y,pupil_mm,lost_L,lost_M,lost_S\n";

/// Columns of the tables, and what they are.
const COLUMNS: [(&str, &str); 20] = [
    ("frame", "number of the frame, or of the file where it has one"),
    ("time_s", "end of the frame, s"),
    ("duration_s", "length of the frame, or of the exposure, s"),
    ("gaze_x, gaze_y", "where the eye looks, fractions of width and height from the top left"),
    ("adapting_cd_m2", "mean luminance over the fovea, cd/m2"),
    ("pupil_mm", "diameter of the pupil, mm"),
    ("sce_L, sce_M, sce_S", "mean Stiles-Crawford weight over the pupil of an equal-energy light"),
    ("fovea_bleached_L, _M, _S", "mean bleached fraction over the fovea, 0 to 1"),
    ("max_bleached_L, _M, _S", "greatest bleached fraction that the frame left, 0 to 1"),
    ("model", "how pigment followed light: none, steady, tracked"),
    ("probe", "name of the place, or gaze"),
    ("I_L, I_M, I_S", "cone illuminance, td"),
    ("p_L, p_M, p_S", "unbleached fraction, 0 to 1"),
    ("X, Y, Z", "percept, cd/m2"),
    ("x, y", "chromaticity of the percept"),
    ("lost_L, lost_M, lost_S", "log10 of the catch unbleached over the catch"),
    ("case", "number of the case, from 0"),
    ("steady_p_L, _M, _S", "unbleached fraction if the light lasted, 0 to 1"),
    ("recovery_95_s", "seconds in the dark until L, M and S are all back at 95 %"),
    ("recovery_50_s, recovery_90_s", "the same for 50 and 90 %"),
];

/// The columns of `trace.csv`, `probes.csv` and `sweep.csv` with their units, for a report.
pub(crate) fn columns() -> Value {
    COLUMNS.iter().map(|&(name, what)| (name.to_owned(), Value::from(what))).collect()
}

/// A point of the picture that is traced through time; `None`: the gaze itself.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Probe {
    pub(crate) name: String,
    at: Option<[f64; 2]>,
}

/// What a probe found in one frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reading {
    pub(crate) probe: String,
    /// Cone illuminance, td.
    pub(crate) illuminance: [f64; 3],
    /// Unbleached fractions.
    pub(crate) p: [f64; 3],
    /// The percept, cd/m2.
    pub(crate) xyz: [f64; 3],
    pub(crate) pupil: Millimetres,
    /// How much less each class of cones catches than if it were unbleached, log10; NaN in the dark.
    pub(crate) lost: [f64; 3],
}

impl Reading {
    /// The columns from `probe` on.
    pub(crate) fn columns(&self) -> String {
        let [x, y] = chromaticity(self.xyz);
        let numbers = [self.illuminance, self.p, self.xyz].concat().into_iter().chain([x, y]);
        let numbers = numbers.chain([self.pupil.0]).chain(self.lost);
        numbers.fold(self.probe.clone(), |row, v| format!("{row},{v}"))
    }

    /// Seconds in the dark until L, M and S are all back at a fraction.
    pub(crate) fn recovery(&self, pigments: &[Kinetics; 3], target: f64) -> f64 {
        let seconds = [0, 1, 2].map(|k| pigments[k].recovery(self.p[k], target).0);
        seconds.into_iter().fold(0.0, f64::max)
    }
}

/// The probes of a configuration; without one, the gaze.
pub(crate) fn probes(config: &Config) -> Vec<Probe> {
    let written = &config.settings.output.probe;
    if written.is_empty() {
        return vec![Probe { name: "gaze".into(), at: None }];
    }
    written.iter().map(|probe| Probe { name: probe.name.clone(), at: Some(probe.at) }).collect()
}

impl Probe {
    /// The probe's pixel of a frame: floor(at * size) of the window, or the one that is looked at.
    pub(crate) fn pixel(&self, planes: &Planes, window: Window, gaze: [f64; 2]) -> [usize; 2] {
        let looked_at = || nearest(gaze, [planes.width, planes.height]);
        self.at.map_or_else(looked_at, |at| window.holding(at))
    }

    /// Reads the probe, whose pixel is given, after a look.
    pub(crate) fn read(
        &self,
        eye: &Eye,
        planes: &Planes,
        look: &Look,
        pixel: [usize; 2],
    ) -> Reading {
        self.reading(eye, planes, look, pixel, eye.fractions_at(look, pixel))
    }

    /// What the probe reads where these fractions are unbleached.
    pub(crate) fn reading(
        &self,
        eye: &Eye,
        planes: &Planes,
        look: &Look,
        pixel: [usize; 2],
        p: [f64; 3],
    ) -> Reading {
        let vision = eye.vision();
        let moments = vision.moments(eye.seen_light(planes), pixel[0], pixel[1]);
        let [whole, catch] = [[1.0; 3], p].map(|p| vision.catch(&moments, p));
        Reading {
            probe: self.name.clone(),
            illuminance: eye.illuminance_at(planes, look, pixel),
            p,
            xyz: vision.xyz(catch),
            pupil: look.pupil,
            lost: [0, 1, 2].map(|k| (whole[k] / catch[k]).log10()),
        }
    }
}

/// The pixel of a picture that is nearest to a place.
pub(crate) fn nearest(place: [f64; 2], size: [usize; 2]) -> [usize; 2] {
    [0, 1].map(|i| (place[i].round().max(0.0) as usize).min(size[i] - 1))
}

/// The row of `trace.csv`.
pub(crate) fn trace_row(
    eye: &Eye,
    planes: &Planes,
    window: Window,
    look: &Look,
    step: &Step,
) -> String {
    let size = [planes.width, planes.height];
    let at = window.fraction(look.gaze);
    let sce = eye.vision().observer.equal_energy_weight(look.pupil, Millimetres(0.0));
    let fovea = foveal_bleaching(eye, size, look);
    let most = look.stats.least.map(|p| 1.0 - p);
    let numbers = [step.end, step.duration(), at[0], at[1], look.adapting.0, look.pupil.0];
    let numbers = numbers.into_iter().chain(sce).chain(fovea).chain(most);
    let row = numbers.fold(step.number.to_string(), |row, v| format!("{row},{v}"));
    format!("{row},{}\n", eye.model_name())
}

/// Mean bleached fraction over the fovea around the gaze.
fn foveal_bleaching(eye: &Eye, size: [usize; 2], look: &Look) -> [f64; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for pixel in eye.fovea(size[0], size[1], look.gaze) {
        let p = eye.fractions_at(look, pixel);
        (0..3).for_each(|k| sum[k] += 1.0 - p[k]);
        count += 1.0;
    }
    if count == 0.0 {
        return eye.fractions_at(look, nearest(look.gaze, size)).map(|p| 1.0 - p);
    }
    sum.map(|s| s / count)
}

/// The rows of `probes.csv` of one frame.
pub(crate) fn probe_rows(readings: &[Reading], step: &Step) -> String {
    let row = |r: &Reading| format!("{},{},{}\n", step.number, step.end, r.columns());
    readings.iter().map(row).collect()
}

/// What became of each probe, from `probes.csv`: its last reading, its greatest bleaching and when,
/// and the seconds in the dark to 50, 90 and 95 %.
///
/// # Errors
/// The table cannot be read.
pub(crate) fn results(path: &Path, pigments: &[Kinetics; 3]) -> Result<Value> {
    let file = std::fs::File::open(path).map_err(Error::io(path, "read"))?;
    let mut results: Vec<(Reading, [(f64, f64); 3])> = Vec::new();
    for line in BufReader::new(file).lines() {
        let line = line.map_err(Error::io(path, "read"))?;
        let Some((time, reading)) = parse(&line) else { continue };
        let at = results.iter().position(|(last, _)| last.probe == reading.probe);
        let at = at.unwrap_or_else(|| {
            results.push((reading.clone(), [(0.0, 0.0); 3]));
            results.len() - 1
        });
        for (most, p) in results[at].1.iter_mut().zip(reading.p) {
            if 1.0 - p > most.0 {
                *most = (1.0 - p, time);
            }
        }
        results[at].0 = reading;
    }
    Ok(results.iter().map(|(last, most)| result(last, most, pigments)).collect())
}

fn result(last: &Reading, most: &[(f64, f64); 3], pigments: &[Kinetics; 3]) -> Value {
    json!({
        "probe": last.probe,
        "p": last.p,
        "Y": last.xyz[1],
        "greatest_bleached": most.map(|(bleached, _)| bleached),
        "greatest_bleached_at_s": most.map(|(_, time)| time),
        "recovery_50_s": last.recovery(pigments, 0.5),
        "recovery_90_s": last.recovery(pigments, 0.9),
        "recovery_95_s": last.recovery(pigments, 0.95),
    })
}

/// At most this many frames of `probes.csv` are plotted, evenly thinned.
const PLOTTED: usize = 2000;

/// Reads `probes.csv` back, so that a resumed run plots what came before: the readings of each
/// frame by its time.
pub(crate) fn read_back(path: &Path) -> Result<Vec<(f64, Vec<Reading>)>> {
    let lines = || -> Result<_> {
        let file = std::fs::File::open(path).map_err(Error::io(path, "read"))?;
        let rows = BufReader::new(file).lines().map_while(|line| line.ok());
        Ok(rows.filter_map(|line| parse(&line)))
    };
    let frames =
        lines()?.fold((0usize, f64::NAN), |(n, last), (t, _)| (n + usize::from(t != last), t)).0;
    let stride = frames.div_ceil(PLOTTED).max(1);
    let (mut history, mut frame, mut last): (Vec<(f64, Vec<Reading>)>, usize, f64) =
        (Vec::new(), 0, f64::NAN);
    for (time, reading) in lines()? {
        frame += usize::from(time != last);
        last = time;
        if (frame - 1) % stride == 0 || frame == frames {
            match history.last_mut() {
                Some((t, readings)) if *t == time => readings.push(reading),
                _ => history.push((time, vec![reading])),
            }
        }
    }
    Ok(history)
}

/// A row; `None` for the header and a comment.
fn parse(line: &str) -> Option<(f64, Reading)> {
    let cells: Vec<&str> = line.split(',').collect();
    let number = |i: usize| cells.get(i)?.parse().ok();
    let triple = |i: usize| Some([number(i)?, number(i + 1)?, number(i + 2)?]);
    let reading = Reading {
        probe: (*cells.get(2)?).to_owned(),
        illuminance: triple(3)?,
        p: triple(6)?,
        xyz: triple(9)?,
        pupil: Millimetres(number(14)?),
        lost: triple(15)?,
    };
    Some((number(1)?, reading))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probes_are_read_back_as_they_were_written_and_thinned_when_they_are_many() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("probes.csv");
        let reading = |i: u32| Reading {
            probe: "sun".into(),
            illuminance: [1e6 / 3.0, 2.0, f64::from(i)],
            p: [0.1, 1.0, 1e-300],
            xyz: [0.0; 3],
            pupil: Millimetres(3.0),
            lost: [0.5; 3],
        };
        let step =
            |i: u32| Step { number: i, file: 0, start: f64::from(i), end: f64::from(i) + 0.1 };
        let rows: String =
            (0..5000).map(|i| probe_rows(&[reading(i), reading(i)], &step(i))).collect();
        std::fs::write(&path, format!("{PROBES}{rows}")).unwrap();
        let history = read_back(&path).unwrap();
        assert!(history.len() <= PLOTTED + 1 && history.len() > PLOTTED / 2);
        assert_eq!(history[0], (step(0).end, vec![reading(0), reading(0)]));
        assert_eq!(
            history[history.len() - 1],
            (step(4999).end, vec![reading(4999), reading(4999)])
        );
    }
}
