//! The steady state as the limit of long exposure, on pictures: every place of a retina, `tracked`
//! beside `steady`, through the eye of a run.
//!
//! With first-order kinetics every place's error falls by e^(-T/(tau p)), p its steady unbleached
//! fraction.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use ndarray::Array3;

use crate::constants::CONSTANTS;
use crate::error::Result;
use crate::eye::pigment::Model;
use crate::eye::retina::Retina;
use crate::eye::{self, Eye, Stimulus};
use crate::frames::Kind;
use crate::kinetics::{Kinetics, Law};
use crate::light::Survey;
use crate::light::{Planes, Samples};
use crate::run::Scene;
use crate::units::{Degrees, Seconds};

use super::limit::{self, STARTS, worst};
use super::{Check, PAPER, STANDARD, Subject};

/// Where the render lies in the project's folder. It is too large to be part of the program.
const RENDER: &str = "data/sunset_mitsuba.exr";

/// Ends of the looks, s: the darkest place comes to within rounding of its steady state.
const ENDS: [f64; 6] = [1.0, 10.0, 60.0, 300.0, 1200.0, 6000.0];

/// Pictures are reduced to about this width.
const WIDTH: usize = 120;

/// Errors that rates are read from: between rounding and the whole.
const READABLE: f64 = 1e-7;

/// A picture to stare at: its name and its `[input]`.
struct Picture {
    name: &'static str,
    input: String,
}

fn pictures() -> Vec<Picture> {
    let sunset = Picture { name: "built-in sunset", input: format!("[input]\nwidth = {WIDTH}\n") };
    let render = render().map(|path| Picture {
        name: "Mitsuba sunset",
        input: format!(
            "[input]\nframes = {:?}\nhorizontal_fov_deg = 8.0\n",
            path.display().to_string()
        ),
    });
    std::iter::once(sunset).chain(render).collect()
}

/// The render, in the folder one works in or in the one the program was built in.
fn render() -> Option<PathBuf> {
    [Path::new(""), Path::new(env!("CARGO_MANIFEST_DIR"))]
        .map(|base| base.join(RENDER))
        .into_iter()
        .find(|p| p.exists())
}

pub(super) fn checks(subject: &Subject) -> Result<Vec<Check>> {
    let mut checks = Vec::new();
    for picture in pictures() {
        for (preset, name) in [(STANDARD, "standard"), (PAPER, "paper")] {
            for narrowing in ["depleted", "narrowed"] {
                let toml = format!("{preset}\nobserver.narrowing = {narrowing:?}\n");
                let stare = Stare::new(subject, &picture, &toml)?;
                checks.extend(
                    stare.checks(&format!("{}, preset {name}, {narrowing}", picture.name))?,
                );
            }
        }
        for set in CONSTANTS.iter().filter(|set| set.name != "standard") {
            let stare =
                Stare::new(subject, &picture, &format!("observer.constants = {:?}\n", set.name))?;
            checks.extend(stare.checks(&format!("{}, constants {}", picture.name, set.name))?);
        }
    }
    if render().is_none() {
        let name = format!("Mitsuba sunset: {RENDER} is not here, nothing looked at");
        checks.push(Check::info(name, "the project's folder", f64::NAN, f64::NAN));
    }
    Ok(checks)
}

/// A stared-at picture, with the steady state of every start.
struct Stare {
    scene: Scene,
    pigments: [Kinetics; 3],
    planes: Planes,
    survey: Arc<Survey>,
    pixels_per_degree: f64,
}

/// What was found after staring from one start.
struct Found {
    /// Rates of fall over theory, each place at each moment at which the error can be read.
    rate: f64,
    /// Largest error of p, and of the percept as a share of its pixel, after the last look.
    error: f64,
    percept: f64,
}

impl Stare {
    fn new(subject: &Subject, picture: &Picture, observer: &str) -> Result<Stare> {
        let config = subject.config(&format!("{observer}{}", picture.input))?;
        let scene = Scene::open(&config)?;
        let projection = match scene.footage.header().kind {
            Kind::Spectral(_) => scene.vision.projection(),
            Kind::Rgb(_) => None,
        };
        let whole = scene.footage.read(0, projection, None)?.planes;
        let step = (whole.width / WIDTH).max(1);
        let planes = every(step, &whole);
        let pixels_per_degree = scene.pixels_per_degree / step as f64;
        let survey = Arc::new(eye::survey(&scene.vision, &planes, pixels_per_degree));
        Ok(Stare { pigments: config.pigments(), scene, planes, survey, pixels_per_degree })
    }

    fn eye(&self, model: Model, start: f64) -> Result<Eye> {
        let Planes { width, height, .. } = self.planes;
        let p = Array3::from_elem((height, 3, width), start);
        let across = Degrees(width as f64 / self.pixels_per_degree);
        Eye::builder(self.scene.vision.clone(), [width, height], across)
            .pigments(self.pigments)
            .model(model, None)
            .retina(Retina::from_fractions(p.view(), [start; 3]))
            .build()
    }

    /// The picture in front of an eye for some seconds.
    fn look(&self, seconds: f64) -> (Stimulus<'_>, [f64; 2], Seconds) {
        (Stimulus::new(&self.planes, &self.survey), self.gaze(), Seconds(seconds))
    }

    fn gaze(&self) -> [f64; 2] {
        [self.planes.width, self.planes.height].map(|n| (n as f64 - 1.0) / 2.0)
    }

    fn stare(&self, start: f64) -> Result<Found> {
        let mut settled = self.eye(Model::Steady, start)?;
        let (stimulus, gaze, duration) = self.look(1.0);
        let end = settled.look_at(stimulus, gaze, duration).percept;
        let steady = settled.retina().fractions();
        let mut eye = self.eye(limit_model(&self.pigments[0]), start)?;
        let (mut time, mut rate, mut percept) = (0.0, 1.0, 0.0);
        let starts = [0.0].into_iter().chain(ENDS);
        let looks = ENDS.iter().zip(starts).map(|(end, start)| self.look(end - start));
        eye.watch(looks, |eye, look| {
            time += look.duration.0;
            let rates = self.rates(start, time, eye.retina().fractions(), steady);
            rate = worst([rate].into_iter().chain(rates), 1.0);
            percept = difference(&look.percept, &end);
        });
        let errors = eye.retina().fractions().iter().zip(steady).map(|(p, end)| (p - end).abs());
        Ok(Found { rate, error: worst(errors, 0.0), percept })
    }

    /// Rate of fall over theory at every place whose error can still be read.
    fn rates<'a>(
        &self,
        start: f64,
        time: f64,
        p: &'a [f64],
        steady: &'a [f64],
    ) -> impl Iterator<Item = f64> + use<'a> {
        let taus = self.pigments.map(|pigment| pigment.tau.0);
        let width = self.planes.width;
        let of_place = move |(i, (p, end)): (usize, (&f64, &f64))| {
            let (first, now) = ((start - end).abs(), (p - end).abs());
            let readable = now > READABLE && first * 0.999 > now;
            readable.then(|| (first / now).ln() / time * taus[i / width % 3] * end)
        };
        p.iter().zip(steady).enumerate().filter_map(of_place)
    }

    fn checks(&self, what: &str) -> Result<Vec<Check>> {
        let found = STARTS.map(|start| self.stare(start));
        let found = found.into_iter().collect::<Result<Vec<_>>>()?;
        let linear = self.pigments[0].law == Law::FirstOrder;
        let rate = worst(found.iter().map(|f| f.rate), 1.0);
        let error = worst(found.iter().map(|f| f.error), 0.0);
        let percept = worst(found.iter().map(|f| f.percept), 0.0);
        let last = ENDS[ENDS.len() - 1];
        let fall =
            Check::new(format!("rate over theory, {what}"), "(1 + I/I0)/tau", rate, 1.0, 1e-6);
        let rest =
            Check::new(format!("p after {last} s, {what}"), "rounding of p", error, 0.0, 1e-14);
        let seen = Check::new(
            format!("percept after {last} s, {what}"),
            "rounding of f32",
            percept,
            0.0,
            2e-6,
        );
        Ok(linear.then_some(fall).into_iter().chain([rest, seen]).collect())
    }
}

/// One step of the first-order law is exact; the others take as many sub-steps as their budget asks
/// for.
fn limit_model(pigment: &Kinetics) -> Model {
    match (limit::tracked(), pigment.law) {
        (Model::Tracked { method, budget, .. }, law) if law != Law::FirstOrder => {
            Model::Tracked { method, substeps: 64, budget }
        }
        (model, _) => model,
    }
}

/// Every `step`th pixel of a picture.
fn every(step: usize, whole: &Planes) -> Planes {
    let (width, height) = (whole.width / step, whole.height / step);
    let mut samples = Vec::with_capacity(width * height * whole.count);
    for y in 0..height {
        for plane in 0..whole.count {
            samples.extend((0..width).map(|x| whole.at(x * step, y * step, plane) as f32));
        }
    }
    Planes { width, height, count: whole.count, samples: Samples::Float(samples) }
}

/// Largest difference of two pictures, as a share of the largest channel of the pixel.
fn difference(a: &Planes, b: &Planes) -> f64 {
    let pixels = (0..a.height).flat_map(|y| (0..a.width).map(move |x| (x, y)));
    let of_pixel = |(x, y): (usize, usize)| {
        let channels = [0, 1, 2].map(|i| (a.at(x, y, i), b.at(x, y, i)));
        let largest = channels.iter().map(|c| c.1.abs()).fold(f64::MIN_POSITIVE, f64::max);
        channels.iter().map(|c| (c.0 - c.1).abs() / largest).fold(0.0, f64::max)
    };
    pixels.map(of_pixel).fold(0.0, f64::max)
}
