//! `peers histories` prints the light histories; `peers` runs sungaze and the Rust solvers on them
//! and prints rows `peer,scene,setting,max_abs_error,ns_per_update,note`. An update is one frame of
//! one place.

mod histories;

use differential_equations::prelude::*;
use histories::{FRAME, History, eye, histories, table};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Dopri5, SVector, System};
use std::time::Instant;
use sungaze::kinetics::Kinetics;
use sungaze::step::{Drive, Method};
use sungaze::units::Trolands;

/// p' = k - lambda p under the light of one frame.
struct Pigment {
    k: f64,
    lambda: f64,
}

impl Pigment {
    fn under(kinetics: &Kinetics, light: f64) -> Self {
        let rates = kinetics.rates(1.0, Trolands(light));
        Pigment { k: rates.regenerate, lambda: rates.sum() }
    }
}

impl System<f64, SVector<f64, 1>> for Pigment {
    fn system(&self, _: f64, p: &SVector<f64, 1>, change: &mut SVector<f64, 1>) {
        change[0] = self.k - self.lambda * p[0];
    }
}

impl ODE for Pigment {
    fn diff(&self, _: f64, p: &f64, change: &mut f64) {
        *change = self.k - self.lambda * *p;
    }
}

const ABSOLUTE: f64 = 1e-9;
const RELATIVE: f64 = 1e-6;
const TOLERANCES: &str = "rtol 1e-6 atol 1e-9";

fn main() {
    let histories = histories();
    if std::env::args().nth(1).as_deref() == Some("histories") {
        print!("{}", table(&histories));
        return;
    }
    for history in &histories {
        for name in ["exact", "forward-euler", "dopri5-adaptive", "radau-iia-5"] {
            let Some(method) = Method::named(name) else { continue };
            let setting = if method.tolerance > 0.0 { "tolerance 1e-6" } else { "1 step a frame" };
            report(&format!("sungaze {name}"), setting, history, |kinetics, p, light| {
                Ok((method.step)(kinetics, p, Drive::Held(Trolands(light)), FRAME))
            });
        }
        report("ode_solvers Dopri5", TOLERANCES, history, dopri5);
        report("ode_solvers Dop853", TOLERANCES, history, dop853);
        report("differential-equations DOP853", TOLERANCES, history, de_dop853);
        report("differential-equations Radau5", TOLERANCES, history, de_radau5);
    }
}

/// Sparse output, because the last value of the dense one is wrong under bright light.
fn dopri5(kinetics: &Kinetics, p: f64, light: f64) -> Result<f64, String> {
    let start = SVector::<f64, 1>::new(p);
    let mut solver = Dopri5::new(Pigment::under(kinetics, light), 0.0, FRAME.0, FRAME.0, start, RELATIVE, ABSOLUTE);
    solver.set_output(OutputType::Sparse);
    solver.integrate().map_err(|error| error.to_string())?;
    solver.y_out().last().map(|p| p[0]).ok_or_else(|| "no output".to_owned())
}

fn dop853(kinetics: &Kinetics, p: f64, light: f64) -> Result<f64, String> {
    let start = SVector::<f64, 1>::new(p);
    let mut solver = Dop853::new(Pigment::under(kinetics, light), 0.0, FRAME.0, FRAME.0, start, RELATIVE, ABSOLUTE);
    solver.set_output(OutputType::Sparse);
    solver.integrate().map_err(|error| error.to_string())?;
    solver.y_out().last().map(|p| p[0]).ok_or_else(|| "no output".to_owned())
}

fn de_dop853(kinetics: &Kinetics, p: f64, light: f64) -> Result<f64, String> {
    let pigment = Pigment::under(kinetics, light);
    let method = ExplicitRungeKutta::dop853().rtol(RELATIVE).atol(ABSOLUTE);
    let solution = IVP::ode(&pigment, 0.0, FRAME.0, p).method(method).solve().map_err(|error| format!("{error:?}"))?;
    solution.y.last().copied().ok_or_else(|| "no output".to_owned())
}

fn de_radau5(kinetics: &Kinetics, p: f64, light: f64) -> Result<f64, String> {
    let pigment = Pigment::under(kinetics, light);
    let method = ImplicitRungeKutta::radau5().rtol(RELATIVE).atol(ABSOLUTE);
    let solution = IVP::ode(&pigment, 0.0, FRAME.0, p).method(method).solve().map_err(|error| format!("{error:?}"))?;
    solution.y.last().copied().ok_or_else(|| "no output".to_owned())
}

/// Run a history once for its error and repeatedly for its time, and print the row.
fn report(peer: &str, setting: &str, history: &History, step: impl Fn(&Kinetics, f64, f64) -> Result<f64, String>) {
    let kinetics = std::hint::black_box(eye());
    let run = || -> Result<f64, String> {
        let mut p = 1.0;
        let mut worst = 0.0;
        for (&light, &truth) in history.lights.iter().zip(&history.truth) {
            p = step(&kinetics, p, light)?;
            worst = f64::max(worst, (p - truth).abs());
        }
        Ok(worst)
    };
    match run() {
        Ok(error) => println!("{peer},{},{setting},{error:.2e},{:.1},", history.name, nanoseconds(&run, history)),
        Err(problem) => println!("{peer},{},{setting},,,{}", history.name, problem.replace([',', '\n'], ";")),
    }
}

/// The median of nine runs, per frame.
fn nanoseconds(run: &dyn Fn() -> Result<f64, String>, history: &History) -> f64 {
    let mut runs: Vec<f64> = (0..9)
        .map(|_| {
            let start = Instant::now();
            (0..20).for_each(|_| drop(std::hint::black_box(run())));
            start.elapsed().as_nanos() as f64 / (20 * history.lights.len()) as f64
        })
        .collect();
    runs.sort_by(f64::total_cmp);
    runs[4]
}
