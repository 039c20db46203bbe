//! The optics stage from outside: the same bits for any number of threads.

use sungaze::light::{Planes, Samples};
use sungaze::optics::{Optics, Psf, Scatter};

/// Suns in a pattern, other in each plane.
fn picture(planes: &[usize]) -> Planes {
    let (width, height, count) = (701, 393, planes.len());
    let light = |plane: usize, at: usize| {
        if (at + 31 * plane).is_multiple_of(9973) { 1e8 } else { (at % 37) as f32 }
    };
    let runs = (0..height).flat_map(|y| planes.iter().map(move |plane| (*plane, y)));
    let samples = runs.flat_map(|(plane, y)| (0..width).map(move |x| light(plane, y * width + x)));
    Planes { width, height, count, samples: Samples::Float(samples.collect()) }
}

fn scattered(threads: usize, s: &Planes) -> Planes {
    let scatter = Scatter { psf: Psf::Cie, ..Scatter::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut out = Planes::float(0, 0, 0);
        let size = [s.width, s.height];
        let mut optics = Optics::new(&scatter, size, 0.05, s.count, 1e-3).unwrap().unwrap();
        optics.exchange(s, None, &mut out);
        out
    })
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let s = picture(&[0, 1, 2]);
    let one = scattered(1, &s);
    assert_eq!(scattered(2, &s), one);
    assert_eq!(scattered(5, &s), one);
}

#[test]
fn planes_are_scattered_alike_however_many_there_are() {
    let three = scattered(2, &picture(&[0, 1, 2]));
    for plane in 0..3 {
        let alone = scattered(2, &picture(&[plane]));
        let same = |x: usize, y: usize| alone.at(x, y, 0) == three.at(x, y, plane);
        assert!((0..393).all(|y| (0..701).all(|x| same(x, y))), "plane {plane}");
    }
}
