//! The error against direct summation in f64 stays below the certificate.

use super::*;
use crate::optics::gaussians::Gaussians;

/// r = s (1 - c) + K s by direct summation in f64 at some places, K the sum of Gaussians itself.
fn direct(sum: &Gaussians, s: &Planes, places: &[[usize; 2]]) -> Vec<f64> {
    let (width, height) = (s.width, s.height);
    let kernel: Vec<f64> =
        (0..width * height).map(|i| sum.at((i % width) as f64, (i / width) as f64)).collect();
    let at = |[x, y]: [usize; 2]| {
        let (mut veil, mut all) = (0.0, 0.0);
        for v in 0..height {
            for u in 0..width {
                let k = kernel[v.abs_diff(y) * width + u.abs_diff(x)];
                all += k;
                veil += k * s.at(u, v, 0);
            }
        }
        s.at(x, y, 0) * (1.0 - all) + veil
    };
    places.iter().map(|place| at(*place)).collect()
}

/// The largest relative error at some places of a random scene, the certificate beside it.
fn error_and_bound(noise: &mut Noise, size: [usize; 2], places: usize) -> (f64, f64) {
    let psf = PSFS[1 + noise.below(5)].1;
    let scatter = Scatter {
        psf,
        age: 20.0 + 60.0 * noise.next(),
        pigmentation: 1.2 * noise.next(),
        straylight: 0.6 + noise.next(),
        core_deg: [0.0, 0.05, 0.1][noise.below(3)],
    };
    let degrees = 0.2 * 0.025f64.powf(noise.next());
    let depth = DEPTHS[noise.below(4)];
    let Ok(Some(mut optics)) = Optics::at_depth(&scatter, size, degrees, 1, depth) else {
        return (0.0, 1.0);
    };
    let contrast = 1e7f64.powf(noise.next());
    let s = scene(noise, size, contrast);
    let places: Vec<[usize; 2]> =
        (0..places).map(|_| [noise.below(size[0]), noise.below(size[1])]).collect();
    let sum = scatter.gaussians(degrees, (size[0] as f64).hypot(size[1] as f64));
    let (ours, truth) = (exchanged(&mut optics, &s, None), direct(&sum, &s, &places));
    let error =
        |(place, truth): (&[usize; 2], &f64)| (ours.at(place[0], place[1], 0) / truth - 1.0).abs();
    (places.iter().zip(&truth).map(error).fold(0.0, f64::max), optics.bound())
}

#[test]
fn the_error_stays_below_the_certificate_in_small_random_scenes() {
    let mut noise = Noise(7);
    let mut closest = 0.0f64;
    for case in 0..300 {
        let size = [1 + noise.below(70), 1 + noise.below(50)];
        let (error, bound) = error_and_bound(&mut noise, size, 20);
        assert!(error <= bound, "scene {case}: {error:e} above {bound:e}");
        closest = closest.max(error / bound);
    }
    // A bound that nothing comes near would prove little.
    assert!(closest > 0.1, "{closest}");
}

/// The same on 480 x 270 and all of its places' light: minutes. `OPTICS_SCENES=50 cargo test
/// --release optics`.
#[test]
fn the_error_stays_below_the_certificate_in_as_many_large_scenes_as_asked() {
    let scenes = std::env::var("OPTICS_SCENES").ok().and_then(|n| n.parse().ok()).unwrap_or(1);
    let mut noise = Noise(11);
    for case in 0..scenes {
        let (error, bound) =
            error_and_bound(&mut noise, [480, 270], if scenes > 1 { 400 } else { 40 });
        assert!(error <= bound, "scene {case}: {error:e} above {bound:e}");
    }
}
