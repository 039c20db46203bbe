//! What is measured: work on pictures in memory and in files, and the bytes that it cannot do
//! without.

mod files;

use half::f16;
use rayon::prelude::*;
use sungaze::colour::Primaries;
use sungaze::display::Display;
use sungaze::eye::pigment::Model;
use sungaze::eye::{Eye, Stimulus, survey};
use sungaze::kernel::{self, FirstOrderForm};
use sungaze::kinetics::Kinetics;
use sungaze::light::{Planes, Samples};
use sungaze::observer::Observer;
use sungaze::spectrum::Bands;
use sungaze::step;
use sungaze::units::{Degrees, Nits, Seconds};
use sungaze::vision::Vision;

const FRAME: Seconds = Seconds(1.0 / 24.0);

/// One thing to measure: its name, the bytes it reads plus those it writes, and the work.
pub(crate) struct Case {
    pub name: String,
    pub bytes: usize,
    pub work: Box<dyn FnMut() + Send>,
    /// How many frames the work goes over.
    pub frames: usize,
    /// Whether it takes all threads, whatever pool it is called in.
    pub whole_machine: bool,
}

impl Case {
    fn new(name: String, bytes: usize, work: impl FnMut() + Send + 'static) -> Case {
        Case { name, bytes, work: Box::new(work), frames: 1, whole_machine: false }
    }
}

/// A case that is still to be set up: its name, or how that begins.
pub(crate) type Planned = (String, Box<dyn FnOnce() -> Case>);

/// Every case for a picture of about so many megapixels.
pub(crate) fn all(megapixels: f64) -> Vec<Planned> {
    let height = ((megapixels * 1e6 / 16.0 * 9.0).sqrt()).round() as usize;
    let width = (megapixels * 1e6 / height as f64).round() as usize;
    let size = [width, height];
    let mut cases = vec![
        planned("state update, indoor to street", move |name| state(name, size, false)),
        planned("state update, a sun in every tile", move |name| state(name, size, true)),
        planned("RGB frame, half", move |name| rgb(name, size)),
        planned("spectral frame, 31 bands", move |name| spectral(name, size)),
        planned("display", move |name| display(name, size)),
    ];
    cases.extend(files::all(size));
    cases
}

fn planned(name: impl Into<String>, set_up: impl FnOnce(String) -> Case + 'static) -> Planned {
    let name = name.into();
    (name.clone(), Box::new(|| set_up(name)))
}

/// A copy that moves as many bytes, read plus written, block by block in the pool's threads.
pub(crate) fn copy(bytes: usize) -> Box<dyn FnMut() + Send> {
    const BLOCK: usize = 256 * 1024;
    let from = vec![1u8; bytes / 2];
    let mut to = vec![0u8; bytes / 2];
    Box::new(move || {
        to.par_chunks_mut(BLOCK)
            .zip(from.par_chunks(BLOCK))
            .for_each(|(to, from)| to.copy_from_slice(from));
        std::hint::black_box(&mut to);
    })
}

/// Numbers without a pattern that a processor could learn, 0 to 1.
fn noise(i: usize) -> f32 {
    let x = (i as u32).wrapping_mul(0x9E37_79B9) ^ 0x5bd1_e995;
    (x ^ (x >> 15)).wrapping_mul(0x85eb_ca6b) as f32 / u32::MAX as f32
}

fn pigments() -> [Kinetics; 3] {
    Kinetics::standard()
}

fn tracked() -> Model {
    Model::Tracked { method: step::EXACT, substeps: 0, budget: 1e-3 }
}

fn state(name: String, [width, height]: [usize; 2], sunny: bool) -> Case {
    let places = width * height;
    let mut p = vec![0.9f64; 3 * places];
    let light: Vec<f32> = (0..3 * places)
        .map(|i| if sunny && i % 256 == 99 { 1e9 } else { 10f32.powf(1.0 + 4.0 * noise(i)) })
        .collect();
    let forms = pigments().map(|pigment| FirstOrderForm::new(&pigment, FRAME));
    let work = move || {
        p.par_chunks_mut(3 * width).zip(light.par_chunks(3 * width)).for_each(|(p, light)| {
            for ((p, light), form) in p.chunks_mut(width).zip(light.chunks(width)).zip(forms) {
                kernel::relax(form, light, p);
            }
        });
    };
    Case::new(name, places * 3 * (8 + 8 + 4), work)
}

/// A whole look, with the picture given back to be written over.
fn look(name: String, vision: Vision, planes: Planes, bytes: usize) -> Case {
    let survey = survey(&vision, &planes, 24.0).into();
    let (size, across) = ([planes.width, planes.height], Degrees(planes.width as f64 / 24.0));
    let eye = Eye::builder(vision, size, across).model(tracked(), None).build();
    let mut eye = eye.unwrap_or_else(|e| panic!("{e}"));
    let gaze = [planes.width as f64 / 2.0, planes.height as f64 / 2.0];
    let work = move || {
        let stimulus = Stimulus::new(&planes, &survey);
        let look = eye.look_at(stimulus, gaze, FRAME);
        eye.recycle(look.percept);
    };
    Case::new(name, bytes, work)
}

fn rgb(name: String, [width, height]: [usize; 2]) -> Case {
    let places = width * height;
    let samples =
        (0..3 * places).map(|i| f16::from_f32(10f32.powf(3.0 * noise(i) - 1.0))).collect();
    let planes = Planes { width, height, count: 3, samples: Samples::Half(samples) };
    let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, Nits(100.0));
    look(
        name,
        vision.unwrap_or_else(|| unreachable!("Rec. 709 has a gamut")),
        planes,
        places * (6 + 6 + 48),
    )
}

fn spectral(name: String, [width, height]: [usize; 2]) -> Case {
    let (places, count) = (width * height, 31);
    let samples = (0..count * places).map(|i| 0.1 * noise(i)).collect();
    let planes = Planes { width, height, count, samples: Samples::Float(samples) };
    let bands =
        Bands::uniform(395.0, 705.0, count).unwrap_or_else(|| unreachable!("31 bands of 10 nm"));
    let vision = Vision::of_held_bands(Observer::standard(), &bands);
    look(name, vision, planes, places * (count * 4 + 12 + 48))
}

fn display(name: String, [width, height]: [usize; 2]) -> Case {
    let places = width * height;
    let light: Vec<f32> = (0..3 * places).map(|i| 10f32.powf(4.0 * noise(i) - 1.0)).collect();
    let display = Display::default();
    let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, Nits(1.0));
    let vision = vision.unwrap_or_else(|| unreachable!("Rec. 709 has a gamut"));
    let planes = Planes { width, height, count: 3, samples: Samples::Float(light.clone()) };
    let map = display.follow(None, &survey(&vision, &planes, 24.0), FRAME);
    let mut bytes = vec![0u8; 3 * places];
    let work = move || {
        bytes.par_chunks_mut(3 * width).zip(light.par_chunks(3 * width)).for_each(
            |(bytes, light)| {
                let [r, g, b] = [0, 1, 2].map(|i| &light[i * width..][..width]);
                display.encode_row(&map, [r, g, b], 1.0, bytes);
            },
        );
    };
    Case::new(name, places * (12 + 3), work)
}
