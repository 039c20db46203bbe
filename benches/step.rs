//! The exact step over a row of places and three cones, f64, one thread, beside a copy of the same
//! bytes.
//!
//! The state is read and written and the light is read: 24 bytes per place and cone, as in the
//! copy.

use divan::{Bencher, black_box};
use sungaze::kinetics::Kinetics;
use sungaze::step::{METHODS, Method, relax};
use sungaze::units::{Seconds, Trolands};

fn main() {
    divan::main();
}

/// Places of a row times three cones.
const PLACES: usize = 3 * 4096;

const FRAME: Seconds = Seconds(1.0 / 24.0);

fn eye() -> Kinetics {
    Kinetics::first_order(Trolands(2e4), Seconds(120.0))
}

/// Light spread evenly in log from 1 to 1e6 td, and every thousandth place on the sun.
fn lights() -> Vec<f64> {
    let light = |i: usize| {
        if i.is_multiple_of(1000) {
            1e10
        } else {
            10f64.powf(6.0 * (i * 7919 % PLACES) as f64 / PLACES as f64)
        }
    };
    (0..PLACES).map(light).collect()
}

fn counter() -> divan::counter::ItemsCount {
    divan::counter::ItemsCount::new(PLACES)
}

/// Read a state and its light, write the state: what any update has to move.
#[divan::bench]
fn copy(bencher: Bencher) {
    let (lights, mut state) = (lights(), vec![1.0; PLACES]);
    bencher.counter(counter()).bench_local(|| {
        for (p, light) in state.iter_mut().zip(black_box(&lights)) {
            *p += *light;
        }
        black_box(&mut state);
    });
}

/// The exact step, called where the compiler sees it.
#[divan::bench]
fn exact_inlined(bencher: Bencher) {
    let (kinetics, lights, mut state) = (black_box(eye()), lights(), vec![1.0; PLACES]);
    bencher.counter(counter()).bench_local(|| {
        for (p, &light) in state.iter_mut().zip(black_box(&lights)) {
            *p = relax(*p, kinetics.rates(*p, Trolands(light)), FRAME);
        }
        black_box(&mut state);
    });
}

/// Every method as a run calls it: through the table, once per place.
#[divan::bench(args = METHODS.iter().map(|method| method.name))]
fn through_the_table(bencher: Bencher, name: &str) {
    let Some(method) = Method::named(name) else { return };
    let (kinetics, lights) = (black_box(eye()), lights());
    bencher.counter(counter()).with_inputs(|| vec![1.0; PLACES]).bench_local_refs(|state| {
        for (p, &light) in state.iter_mut().zip(black_box(&lights)) {
            *p = method.hold(&kinetics, *p, Trolands(light), FRAME, 1);
        }
    });
}
