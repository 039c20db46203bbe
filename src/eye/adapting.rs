//! Luminance: around the gaze and over the picture, for the pupil, and of every cell, for the
//! display.

use std::ops::Range;

use rayon::prelude::*;

use super::Eye;
use crate::kernel::{self, TILE};
use crate::light::{Cells, PlaneTile, Planes, Row, Survey, SurveyRow};
use crate::observer::Adapting;
use crate::units::{Degrees, Nits};
use crate::vision::Vision;

impl Eye {
    /// What the pupil responds to: the mean over the fovea around the gaze (pixels) and over the
    /// picture.
    pub(crate) fn adapting(&self, planes: &Planes, survey: &Survey, gaze: [f64; 2]) -> Adapting {
        let area = (planes.width * planes.height) as f64 / self.pixels_per_degree.powi(2);
        let fovea = self.foveal_mean(planes, gaze);
        Adapting {
            fovea: Nits(fovea),
            picture: Nits(survey.mean),
            area_deg2: area,
            surround: self.surround_luminance(),
        }
    }

    /// Mean luminance of the pixels whose centres lie in the fovea; the nearest pixel if none does.
    fn foveal_mean(&self, planes: &Planes, gaze: [f64; 2]) -> f64 {
        let (mut sum, mut count) = (0.0, 0);
        let (mut room, mut luminances) = ([0.0; TILE], [0.0; TILE]);
        for (y, columns) in self.foveal_rows(planes.width, planes.height, gaze) {
            for from in columns.clone().step_by(TILE) {
                let run = from..columns.end.min(from + TILE);
                let luminances = &mut luminances[..run.len()];
                self.luminances(planes, y, run, &mut room, luminances);
                sum += luminances.iter().map(|v| v.max(0.0)).sum::<f64>();
                count += luminances.len();
            }
        }
        if count > 0 {
            return sum / count as f64;
        }
        let nearest = |v: f64, n: usize| (v.round().max(0.0) as usize).min(n - 1);
        let (x, y) = (nearest(gaze[0], planes.width), nearest(gaze[1], planes.height));
        self.luminances(planes, y, x..x + 1, &mut room, &mut luminances[..1]);
        luminances[0].max(0.0)
    }

    /// Luminances of a run of pixels, cd/m2.
    fn luminances(
        &self,
        planes: &Planes,
        y: usize,
        run: Range<usize>,
        room: &mut [f32; TILE],
        out: &mut [f64],
    ) {
        out.fill(0.0);
        for (i, &weight) in self.vision.luminance.iter().enumerate().filter(|(_, w)| **w != 0.0) {
            for (sum, &sample) in out.iter_mut().zip(planes.run(i, y, run.clone(), room)) {
                *sum += weight * f64::from(sample);
            }
        }
    }

    /// The pixels of a picture whose centres lie within the fovea around a gaze.
    pub(crate) fn fovea(
        &self,
        width: usize,
        height: usize,
        gaze: [f64; 2],
    ) -> impl Iterator<Item = [usize; 2]> {
        self.foveal_rows(width, height, gaze).flat_map(|(y, columns)| columns.map(move |x| [x, y]))
    }

    /// The same, row by row.
    fn foveal_rows(
        &self,
        width: usize,
        height: usize,
        gaze: [f64; 2],
    ) -> impl Iterator<Item = (usize, Range<usize>)> + use<> {
        let Degrees(across) = self.vision.observer.fovea;
        let radius = across / 2.0 * self.pixels_per_degree;
        let span = move |centre: f64, n: usize| {
            let from = (centre - radius).ceil().max(0.0) as usize;
            let to = (centre + radius).floor().min(n as f64 - 1.0);
            from..(to.max(-1.0) + 1.0) as usize
        };
        let inside = move |x: usize, y: usize| {
            let (dx, dy) = (x as f64 - gaze[0], y as f64 - gaze[1]);
            dx * dx + dy * dy <= radius * radius
        };
        span(gaze[1], height).filter_map(move |y| {
            let first = span(gaze[0], width).find(|&x| inside(x, y))?;
            let last = span(gaze[0], width).rfind(|&x| inside(x, y))?;
            Some((y, first..last + 1))
        })
    }
}

/// The centroid, in pixels, of the connected region of a frame that is brighter than half of its
/// greatest luminance, around the first of its brightest pixels.
pub(crate) fn brightest(vision: &Vision, planes: &Planes, survey: &Survey) -> [f64; 2] {
    let Planes { width, height, .. } = *planes;
    let bright = |[x, y]: [usize; 2]| {
        let terms = vision.luminance.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
        let luminance: f64 = terms.map(|(i, weight)| weight * planes.at(x, y, i)).sum();
        luminance > 0.5 * f64::from(survey.greatest)
    };
    let mut seen = vec![false; width * height];
    let mut next: Vec<[usize; 2]> = vec![survey.brightest.into()];
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    while let Some([x, y]) = next.pop() {
        if std::mem::replace(&mut seen[y * width + x], true) || !bright([x, y]) {
            continue;
        }
        sum = [sum[0] + x as f64, sum[1] + y as f64];
        count += 1.0;
        next.extend(
            [x.checked_sub(1).map(|x| [x, y]), y.checked_sub(1).map(|y| [x, y])]
                .into_iter()
                .flatten(),
        );
        next.extend((x + 1 < width).then_some([x + 1, y]));
        next.extend((y + 1 < height).then_some([x, y + 1]));
    }
    let first = [survey.brightest.0 as f64, survey.brightest.1 as f64];
    if count > 0.0 { sum.map(|sum| sum / count) } else { first }
}

/// Luminances of a frame, gathered for the pupil and the display.
pub fn survey(vision: &Vision, planes: &Planes, pixels_per_degree: f64) -> Survey {
    let surveyor = Surveyor::new(vision, planes, pixels_per_degree);
    let rows = 0..planes.height;
    let rows: Vec<_> = rows.into_par_iter().map(|y| surveyor.row(planes.row(y))).collect();
    surveyor.cells.gather(rows)
}

/// Surveys a frame row by row.
pub(super) struct Surveyor {
    pub(crate) cells: Cells,
    weights: Vec<f32>,
    width: usize,
    count: usize,
}

impl Surveyor {
    /// For frames of the size and planes of one.
    pub(super) fn new(vision: &Vision, planes: &Planes, pixels_per_degree: f64) -> Surveyor {
        Surveyor {
            cells: Cells::new(planes.width, planes.height, pixels_per_degree),
            weights: vision.luminance.iter().map(|&w| w as f32).collect(),
            width: planes.width,
            count: planes.count,
        }
    }

    /// What a row adds.
    pub(super) fn row(&self, row: Row<'_>) -> SurveyRow {
        let (mut luminance, mut room) = (vec![0.0; self.width], [0.0; kernel::ROOM]);
        for (from, width) in kernel::tiles(kernel::tile(self.count), self.width) {
            let light = PlaneTile::of(row, self.count, from, width, &mut room);
            kernel::combine(light, &self.weights, &mut luminance[from..from + width]);
        }
        self.cells.row(&luminance)
    }
}
