//! `cargo bench --bench kernels`: each case by size and threads, in divan's table; see `against_copy` for ratios.

mod cases;

const SIZES: [f64; 3] = [0.25, 2.0, 8.0];
const CASES: [usize; 5] = [0, 1, 2, 3, 4];

fn main() {
    divan::main();
}

#[divan::bench(args = CASES, consts = [0, 1, 2], sample_count = 20)]
fn two_threads<const SIZE: usize>(bencher: divan::Bencher, case: usize) {
    measure(bencher, case, SIZES[SIZE], 2);
}

#[divan::bench(args = CASES, consts = [0, 1, 2], sample_count = 20)]
fn one_thread<const SIZE: usize>(bencher: divan::Bencher, case: usize) {
    measure(bencher, case, SIZES[SIZE], 1);
}

fn measure(bencher: divan::Bencher, case: usize, megapixels: f64, threads: usize) {
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else { return };
    let mut case = cases::all(megapixels).swap_remove(case);
    let bytes = divan::counter::BytesCount::new(case.bytes);
    bencher.counter(bytes).bench_local(|| pool.install(|| (case.work)()));
}
