//! How the planes of a frame become cone illuminance under one pupil and gaze.

use crate::kernel::{self, BandSums, ROOM, Strip, TILE};
use crate::light::{Planes, Row, Samples};
use crate::percept::Vision;
use crate::units::Millimetres;

/// One frame's pupil and gaze, in the shape that rows want.
pub(super) struct Sight {
    /// Bands -> the moments' planes of a tile, where frames hold bands.
    bands: Option<BandSums>,
    weakening: Weakening,
    planes_in: usize,
    /// Planes of which a tile needs single floats of its own.
    converted: usize,
}

/// How light is weakened by the place where it enters the pupil.
enum Weakening {
    /// At every place alike: weights of the tile's planes for each cone.
    Alike([Vec<f32>; 3]),
    /// At every place alike, and the tile's planes from this one on are the illuminances but for their floor.
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
    mm_per_pixel: f64,
    /// The pupil's radius, squared: where the weight stops falling, mm2.
    edge: f64,
}

impl Sight {
    pub fn new(vision: &Vision, planes: &Planes, pupil: Millimetres, gaze: [f64; 2], pixels_per_degree: f64) -> Self {
        let held = vision.holds_bands();
        let converted = if let Samples::Half(_) = planes.samples { planes.count } else { 0 };
        let first = vision.first_illuminance();
        let scale = vision.observer.directional.mm_per_degree().map(|mm| mm / pixels_per_degree);
        let single = |row: Vec<f64>| -> Vec<f32> { row.into_iter().map(|w| w as f32).collect() };
        let moment = |row: usize| single(vision.moment_weights(row));
        let Some(mm_per_pixel) = scale else {
            let weights = [0, 1, 2].map(|k| single(uniform_weights(vision, pupil, k)));
            return Sight {
                bands: held.then(|| BandSums::new(&(0..first).map(moment).chain(weights.clone()).collect::<Vec<_>>())),
                weakening: if held { Weakening::Summed(first) } else { Weakening::Alike(weights) },
                planes_in: planes.count,
                converted,
            };
        };
        let rates: Vec<f64> =
            vision.observer.directional.levels().iter().map(|p| p * std::f64::consts::LN_10).collect();
        let level = |k: usize, j: usize| {
            let row = first + k * rates.len() + j;
            let scale = vision.observer.cone_troland()[k] * crate::eye::pupil::area(pupil);
            let weights = if held { unit(row) } else { moment(row) };
            weights.into_iter().map(|w| (f64::from(w) * scale) as f32).collect()
        };
        let levels = [0, 1, 2].map(|k| (0..rates.len()).map(|j| level(k, j)).collect());
        let edge = (pupil.0 / 2.0).powi(2);
        Sight {
            bands: held.then(|| BandSums::new(&(0..vision.moment_count()).map(moment).collect::<Vec<_>>())),
            weakening: Weakening::ByPlace(ByPlace { rates, levels, gaze, mm_per_pixel, edge }),
            planes_in: planes.count,
            converted,
        }
    }

    /// The most places of a tile.
    pub fn tile(&self) -> usize {
        kernel::tile(self.converted + self.bands.as_ref().map_or(0, BandSums::rows))
    }

    /// The tiles of a row: where each begins and how wide it is.
    pub fn tiles(&self, width: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        kernel::tiles(self.tile(), width)
    }

    /// The light of one tile: RGB, or the moments.
    pub fn light<'a>(&self, row: Row<'a>, from: usize, width: usize, room: &'a mut [f32; ROOM]) -> Strip<'a> {
        let Some(sums) = &self.bands else { return Strip::of(row, self.planes_in, from, width, room) };
        let (projected, converted) = room.split_at_mut(sums.rows() * width);
        sums.project(Strip::of(row, self.planes_in, from, width, converted), projected);
        Strip::whole(projected, width)
    }

    /// Cone illuminance of one tile, td, whose first place is at `x`, `y` of the picture. Returns the greatest.
    pub fn illuminance(&self, light: Strip<'_>, [x, y]: [usize; 2], td: [&mut [f32]; 3]) -> [f32; 3] {
        match &self.weakening {
            Weakening::Alike(weights) => kernel::illuminance(light, weights, td),
            Weakening::Summed(first) => kernel::floored([0, 1, 2].map(|k| light.plane(first + k)), td),
            Weakening::ByPlace(by_place) => by_place.illuminance(light, [x, y], td),
        }
    }
}

impl ByPlace {
    fn illuminance(&self, light: Strip<'_>, [x, y]: [usize; 2], td: [&mut [f32]; 3]) -> [f32; 3] {
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

/// More levels of the Stiles-Crawford weight than any steepness asks for.
const MOST_LEVELS: usize = 16;

/// Picks one plane.
fn unit(plane: usize) -> Vec<f32> {
    (0..=plane).map(|i| if i == plane { 1.0 } else { 0.0 }).collect()
}

/// Weights of the frame's planes in a cone's illuminance, where place does not matter.
fn uniform_weights(vision: &Vision, pupil: Millimetres, k: usize) -> Vec<f64> {
    let levels = &vision.illuminance_weights(pupil, Millimetres(0.0))[k];
    let first = vision.first_illuminance() + k * levels.len();
    let mut sum = vec![0.0; vision.moment_weights(0).len()];
    for (j, weight) in levels.iter().enumerate() {
        for (total, w) in sum.iter_mut().zip(vision.moment_weights(first + j)) {
            *total += weight * w;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eye::{Directional, Observer, Reading, Steepness};
    use crate::light::Primaries;
    use crate::spectrum::Bands;
    use crate::units::Nits;

    const PUPIL: Millimetres = Millimetres(3.1);
    const GAZE: [f64; 2] = [70.3, 1.2];
    const PIXELS_PER_DEGREE: f64 = 11.0;

    /// Every place of a picture against the scalar illuminance.
    fn agrees(vision: &Vision, planes: &Planes) {
        let sight = Sight::new(vision, planes, PUPIL, GAZE, PIXELS_PER_DEGREE);
        let scale = vision.observer.directional.mm_per_degree().unwrap_or(0.0) / PIXELS_PER_DEGREE;
        let (mut room, mut td) = ([0.0; kernel::ROOM], [[0.0; TILE]; 3]);
        for y in 0..planes.height {
            for (from, width) in sight.tiles(planes.width) {
                let light = sight.light(planes.row(y), from, width, &mut room);
                sight.illuminance(light, [from, y], td.each_mut().map(|td| &mut td[..width]));
                for i in (0..width).rev() {
                    let r = Millimetres(scale * ((from + i) as f64 - GAZE[0]).hypot(y as f64 - GAZE[1]));
                    let weights = vision.illuminance_weights(PUPIL, r);
                    let exact = vision.illuminance(&vision.moments(planes, from + i, y), &weights);
                    for (td, exact) in td.iter().zip(exact) {
                        assert!((f64::from(td[i]) / exact - 1.0).abs() < 1e-5, "{i} {} {exact}", td[i]);
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
            agrees(&Vision::of_rgb(observer.clone(), &Primaries::REC709, Nits(100.0)).unwrap(), &picture(3));
            let bands = Bands::uniform(395.0, 705.0, 31).unwrap();
            agrees(&Vision::of_held_bands(observer, &bands), &picture(31));
        }
    }

    #[test]
    fn no_steepness_asks_for_more_levels_than_there_is_room_for() {
        for reading in [Reading::Pupil, Reading::Paper { mm_per_degree: 0.29 }] {
            let steep = Directional::new(reading, Steepness::LensCorrected);
            assert!(steep.levels().len() <= MOST_LEVELS);
        }
    }
}
