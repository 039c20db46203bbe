//! The illuminance stage: planes of a frame to cone illuminance under one pupil and gaze.

use crate::kernel::{self, BandSums, ROOM, TILE};
use crate::light::PlaneTile;
use crate::light::{Planes, Row, Samples};
use crate::observer::directional::MOST_LEVELS;
use crate::units::Millimetres;
use crate::vision::Vision;

/// Linear operator from a tile's planes to cone illuminance, aimed by one frame's pupil and gaze.
pub(super) struct IlluminanceOperator {
    /// Bands -> the moments' planes of a tile, where frames hold bands.
    bands: Option<BandSums>,
    weighting: PupilWeighting,
    planes_in: usize,
    /// Planes of which a tile needs single floats of its own.
    converted: usize,
}

/// How light is weakened by the place where it enters the pupil.
enum PupilWeighting {
    /// At every place alike: weights of the tile's planes for each cone.
    Alike([Vec<f32>; 3]),
    /// At every place alike, and the tile's planes from this one on are the illuminances but for
    /// their floor.
    Summed(usize),
    /// By the distance from the gaze (the paper's reading).
    ByPlace(ByPlace),
}

struct ByPlace {
    /// ln 10 times the levels of p, mm^-2.
    rates: Vec<f64>,
    /// Weights of the tile's planes for each cone and level.
    levels: [Vec<Vec<f32>>; 3],
    gaze: [f64; 2],
    mm_per_degree: f64,
    mm_per_pixel: f64,
    /// The pupil's radius, squared: where the weight stops falling, mm2.
    edge: f64,
}

impl IlluminanceOperator {
    /// An operator that is still to be aimed.
    pub(super) fn new(vision: &Vision) -> Self {
        let (held, first, planes) =
            (vision.holds_bands(), vision.first_illuminance(), vision.plane_count());
        let mm_per_degree = vision.observer.directional.mm_per_degree();
        // Beside the catches: one illuminance a cone, or one for each cone and level.
        let rows = if mm_per_degree.is_some() { vision.moment_count() } else { first + 3 };
        let bands = held.then(|| {
            let mut sums = BandSums::new(rows);
            let kept = if mm_per_degree.is_some() { rows } else { first };
            (0..kept).for_each(|row| {
                sums.set(row, (0..planes).map(|band| vision.moment_weight(row, band) as f32))
            });
            sums
        });
        let of_planes = || vec![0.0; if held { rows } else { planes }];
        let weighting = match mm_per_degree {
            None if held => PupilWeighting::Summed(first),
            None => PupilWeighting::Alike([(); 3].map(|()| of_planes())),
            Some(mm_per_degree) => {
                let levels = vision.observer.directional.levels();
                PupilWeighting::ByPlace(ByPlace {
                    rates: levels.iter().map(|p| p * std::f64::consts::LN_10).collect(),
                    levels: [(); 3].map(|()| vec![of_planes(); levels.len()]),
                    gaze: [0.0; 2],
                    mm_per_degree,
                    mm_per_pixel: 0.0,
                    edge: 0.0,
                })
            }
        };
        IlluminanceOperator { bands, weighting, planes_in: planes, converted: 0 }
    }

    /// Aims at a frame.
    pub(super) fn aim(
        &mut self,
        vision: &Vision,
        planes: &Planes,
        pupil: Millimetres,
        gaze: [f64; 2],
        pixels_per_degree: f64,
    ) {
        self.planes_in = planes.count;
        self.converted = if let Samples::Half(_) = planes.samples { planes.count } else { 0 };
        match (&mut self.weighting, &mut self.bands) {
            (PupilWeighting::Alike(weights), _) => {
                for (weights, of_cone) in weights.iter_mut().zip(uniform_weights(vision, pupil)) {
                    weights
                        .iter_mut()
                        .enumerate()
                        .for_each(|(plane, weight)| *weight = of_cone(plane));
                }
            }
            (PupilWeighting::Summed(first), Some(bands)) => {
                for (k, of_cone) in uniform_weights(vision, pupil).into_iter().enumerate() {
                    bands.set(*first + k, (0..planes.count).map(of_cone));
                }
            }
            (PupilWeighting::Summed(_), None) => {}
            (PupilWeighting::ByPlace(by_place), _) => {
                by_place.aim(vision, pupil, gaze, pixels_per_degree)
            }
        }
    }

    /// The most places of a tile.
    pub(super) fn tile(&self) -> usize {
        kernel::tile(self.converted + self.bands.as_ref().map_or(0, BandSums::rows))
    }

    /// The tiles of a row: where each begins and how wide it is.
    pub(super) fn tiles(&self, width: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        kernel::tiles(self.tile(), width)
    }

    /// The light of one tile: RGB, or the moments.
    pub(super) fn light<'a>(
        &self,
        row: Row<'a>,
        from: usize,
        width: usize,
        room: &'a mut [f32; ROOM],
    ) -> PlaneTile<'a> {
        let Some(sums) = &self.bands else {
            return PlaneTile::of(row, self.planes_in, from, width, room);
        };
        let (projected, converted) = room.split_at_mut(sums.rows() * width);
        sums.project(PlaneTile::of(row, self.planes_in, from, width, converted), projected);
        PlaneTile::whole(projected, width)
    }

    /// Cone illuminance of one tile, td, whose first place is at `x`, `y` of the picture. Returns
    /// the greatest.
    pub(super) fn illuminance(
        &self,
        light: PlaneTile<'_>,
        [x, y]: [usize; 2],
        td: [&mut [f32]; 3],
    ) -> [f32; 3] {
        match &self.weighting {
            PupilWeighting::Alike(weights) => kernel::illuminance(light, weights, td),
            PupilWeighting::Summed(first) => {
                kernel::floored([0, 1, 2].map(|k| light.plane(first + k)), td)
            }
            PupilWeighting::ByPlace(by_place) => by_place.illuminance(light, [x, y], td),
        }
    }
}

impl ByPlace {
    fn aim(&mut self, vision: &Vision, pupil: Millimetres, gaze: [f64; 2], pixels_per_degree: f64) {
        self.gaze = gaze;
        self.mm_per_pixel = self.mm_per_degree / pixels_per_degree;
        self.edge = (pupil.0 / 2.0).powi(2);
        let (held, first, count) =
            (vision.holds_bands(), vision.first_illuminance(), self.rates.len());
        for (k, levels) in self.levels.iter_mut().enumerate() {
            let scale = vision.observer.cone_troland()[k] * crate::observer::pupil::area(pupil);
            for (j, weights) in levels.iter_mut().enumerate() {
                let row = first + k * count + j;
                for (plane, weight) in weights.iter_mut().enumerate() {
                    let of_plane = if held {
                        f64::from(u8::from(plane == row))
                    } else {
                        vision.moment_weight(row, plane)
                    };
                    *weight = (f64::from(of_plane as f32) * scale) as f32;
                }
            }
        }
    }

    fn illuminance(
        &self,
        light: PlaneTile<'_>,
        [x, y]: [usize; 2],
        td: [&mut [f32]; 3],
    ) -> [f32; 3] {
        let width = light.width();
        let across = self.mm_per_pixel * (y as f64 - self.gaze[1]);
        let squares: [f64; TILE] = std::array::from_fn(|i| {
            let along = self.mm_per_pixel * ((x + i) as f64 - self.gaze[0]);
            (along * along + across * across).min(self.edge)
        });
        let (mut sums, mut most) = ([[0.0; TILE]; MOST_LEVELS], [0.0; 3]);
        for ((levels, td), most) in self.levels.iter().zip(td).zip(&mut most) {
            for (weights, sum) in levels.iter().zip(&mut sums) {
                kernel::combine(light, weights, &mut sum[..width]);
            }
            kernel::weaken(&self.rates, &squares, &sums, td);
            *most = kernel::greatest(td);
        }
        most
    }
}

/// The weight of each of a frame's planes in each cone's illuminance, where place does not matter.
fn uniform_weights(vision: &Vision, pupil: Millimetres) -> [impl Fn(usize) -> f32 + '_; 3] {
    let (first, count) = (vision.first_illuminance(), vision.observer.directional.levels().len());
    let levels = vision.illuminance_weights(pupil, Millimetres(0.0));
    [0, 1, 2].map(|k| {
        move |plane: usize| {
            let of_level =
                |j: usize| levels[k][j] * vision.moment_weight(first + k * count + j, plane);
            (0..count).map(of_level).sum::<f64>() as f32
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Primaries;
    use crate::observer::{Directional, Observer, Reading, Steepness};
    use crate::spectrum::Bands;
    use crate::units::Nits;

    const PUPIL: Millimetres = Millimetres(3.1);
    const GAZE: [f64; 2] = [70.3, 1.2];
    const PIXELS_PER_DEGREE: f64 = 11.0;

    /// Every place of a picture against the scalar illuminance.
    fn agrees(vision: &Vision, planes: &Planes) {
        let mut sight = IlluminanceOperator::new(vision);
        sight.aim(vision, planes, PUPIL, GAZE, PIXELS_PER_DEGREE);
        let scale = vision.observer.directional.mm_per_degree().unwrap_or(0.0) / PIXELS_PER_DEGREE;
        let (mut room, mut td) = ([0.0; kernel::ROOM], [[0.0; TILE]; 3]);
        for y in 0..planes.height {
            for (from, width) in sight.tiles(planes.width) {
                let light = sight.light(planes.row(y), from, width, &mut room);
                sight.illuminance(light, [from, y], td.each_mut().map(|td| &mut td[..width]));
                for i in (0..width).rev() {
                    let r = Millimetres(
                        scale * ((from + i) as f64 - GAZE[0]).hypot(y as f64 - GAZE[1]),
                    );
                    let weights = vision.illuminance_weights(PUPIL, r);
                    let exact = vision.illuminance(&vision.moments(planes, from + i, y), &weights);
                    for (td, exact) in td.iter().zip(exact) {
                        assert!(
                            (f64::from(td[i]) / exact - 1.0).abs() < 1e-5,
                            "{i} {} {exact}",
                            td[i]
                        );
                    }
                }
            }
        }
    }

    fn picture(count: usize) -> Planes {
        let samples = (0..300 * 3 * count).map(|i| 1.0 + (i as f32 * 0.61).sin()).collect();
        Planes { width: 300, height: 3, count, samples: Samples::Float(samples) }
    }

    #[test]
    fn every_reading_of_the_directional_weight_agrees_with_the_scalar_one_in_rgb_and_in_bands() {
        for reading in [Reading::Pupil, Reading::Paper { mm_per_degree: 0.29 }, Reading::Off] {
            let mut observer = Observer::standard();
            observer.directional = Directional::new(reading, Steepness::LensCorrected);
            agrees(
                &Vision::of_rgb(observer.clone(), &Primaries::REC709, Nits(100.0)).unwrap(),
                &picture(3),
            );
            let bands = Bands::uniform(395.0, 705.0, 31).unwrap();
            agrees(&Vision::of_held_bands(observer, &bands), &picture(31));
        }
    }
}
