//! `ladder`: what each rung of modelling costs and how far it errs, scene by scene, and which one
//! `auto` chose.
//!
//! The truth is the rung `full`: f64, every band, catches by their definition, sixteen sub-steps,
//! at every eighth place in both directions. Costs are for light in memory to percept in memory, on
//! the pool of the caller.

use super::difference::{ciede2000, lab};
use super::ladder_figure::{self, BUDGET, Rung};
use super::ladder_scenes::{Scene, scenes};
use super::{Progress, write_csv};
use crate::colour;
use crate::display::Display;
use crate::error::{Error, Result};
use crate::eye::pigment::Model;
use crate::eye::plan::{Plan, SUBSTEPS};
use crate::eye::{Eye, Stimulus, Surround, survey};
use crate::kinetics::Kinetics;
use crate::light::{Planes, Survey};
use crate::spectrum::Curve;
use crate::step;
use crate::units::{Degrees, Millimetres, Nits, Seconds};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Every so many places are followed at full model.
const STRIDE: usize = 8;

const PIXELS_PER_DEGREE: f64 = 8.0;

/// What was seen at the followed places: fractions after each frame, and at the end catches and
/// colours.
struct Seen {
    p: Vec<[f64; 3]>,
    catch: Vec<[f64; 3]>,
    colours: Vec<[u8; 3]>,
    cost_ms: f64,
}

fn pigments() -> [Kinetics; 3] {
    Kinetics::standard()
}

fn tracked() -> Model {
    let method = step::EXACT;
    Model::Tracked { method, substeps: 0, budget: SUBSTEPS * BUDGET }
}

pub(super) fn write(out_dir: &Path, progress: Progress) -> Result<()> {
    let mut found = Vec::new();
    for scene in scenes()? {
        progress(&format!("ladder: {}", scene.title));
        let rungs = climb(&scene)?;
        found.push((scene, rungs));
    }
    let header = "scene,rung,ms_per_megapixel_frame,max_error_p,max_error_catch,delta_e_2000_p95,delta_e_2000_max,bound,chosen";
    let row = |scene: &Scene, r: &Rung| {
        let bound = r.bound.map_or(String::new(), |bound| format!("{bound:.3e}"));
        let ([p, catch], [most, max]) = (r.errors, r.differences);
        format!(
            "{},{},{:.3},{p:.3e},{catch:.3e},{most:.3},{max:.3},{bound},{}",
            scene.name, r.name, r.cost_ms, r.chosen
        )
    };
    let rows =
        found.iter().flat_map(|(scene, rungs)| rungs.iter().map(move |rung| row(scene, rung)));
    write_csv(out_dir, "ladder", header, rows)?;
    let rungs: Vec<(&str, &[Rung])> =
        found.iter().map(|(scene, rungs)| (scene.title, rungs.as_slice())).collect();
    ladder_figure::drawn(&rungs).write(out_dir, "ladder")
}

/// Rounds over the rungs of a scene: they take turns, so that all meet the same noise.
const ROUNDS: usize = 7;

/// Every rung on one scene, the truth last but one, what `auto` did last.
fn climb(scene: &Scene) -> Result<Vec<Rung>> {
    let truth = full(scene)?;
    let asked = [
        (Model::Unbleached, None),
        (Model::Steady, None),
        (tracked(), None),
        (tracked(), Some(BUDGET)),
    ];
    let [none, steady, followed, (auto, plan)] = in_turns(scene, asked)?;
    let chosen = plan.name(tracked());
    let mut rungs = Vec::new();
    for (model, (ours, asked)) in
        [(Model::Unbleached, none), (Model::Steady, steady), (tracked(), followed)]
    {
        let bound = match model {
            Model::Unbleached => plan.bound_of_none(&pigments()),
            model => asked.bound(model, &pigments()),
        };
        rungs.push(rung(model.name(), &ours, &truth, bound, chosen));
    }
    rungs.push(rung("full", &truth, &truth, Some(0.0), chosen));
    rungs.push(rung("auto", &auto, &truth, plan.bound(tracked(), &pigments()), chosen));
    Ok(rungs)
}

/// The scene by each model and budget; costs are medians of the rounds.
fn in_turns<const N: usize>(
    scene: &Scene,
    asked: [(Model, Option<f64>); N],
) -> Result<[(Seen, Plan); N]> {
    let round = || -> Result<Vec<(Seen, Plan)>> {
        asked.iter().map(|&(model, budget)| seen(scene, model, budget)).collect()
    };
    let mut costs: [Vec<f64>; N] = [const { Vec::new() }; N];
    for _ in 1..ROUNDS {
        costs.iter_mut().zip(round()?).for_each(|(costs, (seen, _))| costs.push(seen.cost_ms));
    }
    let mut found = round()?;
    for ((seen, _), mut costs) in found.iter_mut().zip(costs) {
        costs.push(seen.cost_ms);
        costs.sort_by(f64::total_cmp);
        seen.cost_ms = costs[costs.len() / 2];
    }
    found.try_into().map_err(|_| Error::light("a rung is missing"))
}

fn rung(name: &'static str, ours: &Seen, truth: &Seen, bound: Option<f64>, chosen: &str) -> Rung {
    let worst = |a: &[[f64; 3]], b: &[[f64; 3]], error: fn(f64, f64) -> f64| {
        a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| error(*a, *b)).fold(0.0, f64::max)
    };
    let apart = ours.colours.iter().zip(&truth.colours).map(|(a, b)| ciede2000(lab(*a), lab(*b)));
    let mut apart: Vec<f64> = apart.collect();
    apart.sort_by(f64::total_cmp);
    Rung {
        name,
        cost_ms: ours.cost_ms,
        errors: [
            worst(&ours.p, &truth.p, |a, b| (a - b).abs()),
            worst(
                &ours.catch,
                &truth.catch,
                |a, b| if b > 0.0 { (a / b - 1.0).abs() } else { 0.0 },
            ),
        ],
        differences: [apart[apart.len() * 95 / 100], apart[apart.len() - 1]],
        bound,
        chosen: name == chosen,
    }
}

fn followed(planes: &Planes) -> Vec<[usize; 2]> {
    let rows = (0..planes.height).step_by(STRIDE);
    rows.flat_map(|y| (0..planes.width).step_by(STRIDE).map(move |x| [x, y])).collect()
}

/// An eye for a scene.
fn eye(scene: &Scene, model: Model, budget: Option<f64>) -> Result<Eye> {
    let Planes { width, height, .. } = scene.pictures[0];
    let across = Degrees(width as f64 / PIXELS_PER_DEGREE);
    // What an eye would take from its first look; the truth asks for the pupil without looking.
    let edge = surveys(scene)[0].edge;
    Eye::builder(scene.vision.clone(), [width, height], across)
        .pigments(pigments())
        .surround(Surround::Uniform(Nits(edge)))
        .model(model, budget)
        .build()
}

fn surveys(scene: &Scene) -> Vec<Arc<Survey>> {
    let survey = |p: &Planes| Arc::new(survey(&scene.vision, p, PIXELS_PER_DEGREE));
    scene.pictures.iter().map(survey).collect()
}

/// A scene through the eye that runs use.
fn seen(scene: &Scene, model: Model, budget: Option<f64>) -> Result<(Seen, Plan)> {
    let mut eye = eye(scene, model, budget)?;
    let surveys = surveys(scene);
    let frame = |&(picture, dt): &(usize, Seconds)| {
        let planes = &scene.pictures[picture];
        (Stimulus::new(planes, &surveys[picture]), gaze(planes), dt)
    };
    let last = &scene.pictures[scene.frames[scene.frames.len() - 1].0];
    let places = followed(last);
    let (mut p, mut rgb, mut costs, mut begun) =
        (Vec::new(), Vec::new(), Vec::new(), Instant::now());
    eye.watch(scene.frames.iter().map(frame), |eye, look| {
        costs.push(1e3 * begun.elapsed().as_secs_f64());
        p.extend(places.iter().map(|&at| eye.fractions_at(look, at)));
        rgb = places.iter().map(|at| [0, 1, 2].map(|i| look.percept.at(at[0], at[1], i))).collect();
        begun = Instant::now();
    });
    let now = &p[p.len() - places.len()..];
    let catch = |(at, p): (&[usize; 2], &[f64; 3])| {
        scene.vision.catch(&scene.vision.moments(last, at[0], at[1]), *p)
    };
    let catch: Vec<[f64; 3]> = places.iter().zip(now).map(catch).collect();
    let colours = shown(scene, &rgb);
    costs.sort_by(f64::total_cmp);
    let cost_ms = costs[costs.len() / 2] / megapixels(last);
    Ok((Seen { p, catch, colours, cost_ms }, eye.plan().clone()))
}

/// A scene at full model, at the followed places.
fn full(scene: &Scene) -> Result<Seen> {
    let places = followed(&scene.pictures[0]);
    let first = &scene.pictures[0];
    let (eye, surveys) = (eye(scene, Model::Unbleached, None)?, surveys(scene));
    let (mut now, mut p) = (vec![[1.0; 3]; places.len()], Vec::new());
    let begun = Instant::now();
    for &(picture, dt) in &scene.frames {
        let planes = &scene.pictures[picture];
        let adapting = eye.adapting(planes, &surveys[picture], gaze(planes));
        let pupil = scene.vision.observer.pupil.diameter(adapting);
        for (at, p) in places.iter().zip(&mut now) {
            let td = scene.vision.observer.illuminance(
                &radiance(scene, planes, *at),
                pupil,
                Millimetres(0.0),
            );
            *p = [0, 1, 2].map(|k| step::advance(&pigments()[k], p[k], td[k], dt, 16));
        }
        p.extend_from_slice(&now);
    }
    let stepping = begun.elapsed().as_secs_f64() / scene.frames.len() as f64;
    let last = &scene.pictures[scene.frames[scene.frames.len() - 1].0];
    let begun = Instant::now();
    let catch: Vec<[f64; 3]> = places
        .iter()
        .zip(&now)
        .map(|(at, p)| scene.vision.observer.catch(&radiance(scene, last, *at), *p))
        .collect();
    let catching = begun.elapsed().as_secs_f64();
    let rgb: Vec<[f64; 3]> =
        catch.iter().map(|catch| colour::apply(&scene.vision.lms_to_seen, *catch)).collect();
    let share = places.len() as f64 / (first.width * first.height) as f64;
    let cost_ms = 1e3 * (stepping + catching) / share / megapixels(first);
    Ok(Seen { p, catch, colours: shown(scene, &rgb), cost_ms })
}

fn radiance(scene: &Scene, planes: &Planes, [x, y]: [usize; 2]) -> Curve {
    let mut light = Curve::sampled(|_| 0.0);
    for (i, basis) in scene.vision.basis().iter().enumerate() {
        let value = planes.at(x, y, i);
        light.0.iter_mut().zip(&basis.0).for_each(|(sum, b)| *sum += value * b);
    }
    light
}

fn gaze(planes: &Planes) -> [f64; 2] {
    [planes.width as f64 / 2.0, planes.height as f64 / 2.0]
}

fn megapixels(planes: &Planes) -> f64 {
    (planes.width * planes.height) as f64 / 1e6
}

/// Percepts at the end as the display shows them, under the map of the last picture's own light.
fn shown(scene: &Scene, percepts: &[[f64; 3]]) -> Vec<[u8; 3]> {
    let last = &scene.pictures[scene.frames[scene.frames.len() - 1].0];
    let display = Display::default();
    let map = display.follow(None, &survey(&scene.vision, last, PIXELS_PER_DEGREE), Seconds(1.0));
    let srgb: Vec<[f64; 3]> =
        percepts.iter().map(|rgb| colour::apply(&scene.vision.seen_to_srgb, *rgb)).collect();
    let planes: [Vec<f32>; 3] = [0, 1, 2].map(|i| srgb.iter().map(|rgb| rgb[i] as f32).collect());
    let mut bytes = vec![0; 3 * srgb.len()];
    display.encode_row(&map, planes.each_ref().map(Vec::as_slice), 1.0, &mut bytes);
    bytes.as_chunks().0.to_vec()
}
