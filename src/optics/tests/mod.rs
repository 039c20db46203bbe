//! Laws of the operator.

mod certificate;
mod sun;

use crate::light::Samples;

use super::*;
use half::f16;

fn cie() -> Scatter {
    Scatter { psf: Psf::Cie, ..Scatter::default() }
}

fn floats(planes: &Planes) -> &[f32] {
    match &planes.samples {
        Samples::Float(samples) => samples,
        Samples::Half(_) => panic!("planes of halves"),
    }
}

/// A picture of one plane.
fn picture([width, height]: [usize; 2], light: impl Fn(usize, usize) -> f32) -> Planes {
    let samples = (0..width * height).map(|i| light(i % width, i / width)).collect();
    Planes { width, height, count: 1, samples: Samples::Float(samples) }
}

fn exchanged(optics: &mut Optics, s: &Planes, beyond: Option<&[f32]>) -> Planes {
    let mut out = Planes::float(0, 0, 0);
    optics.exchange(s, beyond, &mut out);
    out
}

fn optics(scatter: &Scatter, size: [usize; 2], degrees: f64, budget: f64) -> Optics {
    Optics::new(scatter, size, degrees, 1, budget).unwrap().unwrap()
}

/// Random numbers, 0 to 1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }
}

/// A field of about 1 to `contrast` with lamps and a sun in it.
fn scene(noise: &mut Noise, [width, height]: [usize; 2], contrast: f64) -> Planes {
    let (texture, slope) = (noise.next() < 0.5, noise.next());
    let grain: Vec<f64> = (0..width * height).map(|_| noise.next()).collect();
    let mut light: Vec<f32> = (0..width * height)
        .map(|i| {
            let across = slope * (i % width) as f64 / width as f64;
            (1.0 + 30.0 * across + if texture { 20.0 * grain[i] * grain[i] } else { 0.0 }) as f32
        })
        .collect();
    for _ in 0..noise.below(12) {
        light[noise.below(width * height)] = contrast.powf(noise.next()) as f32;
    }
    let ([x, y], r) = (
        [noise.below(width), noise.below(height)].map(|v| v as f64),
        1.0 + 0.1 * noise.next() * height as f64,
    );
    for (i, light) in light.iter_mut().enumerate() {
        if ((i % width) as f64 - x).hypot((i / width) as f64 - y) < r {
            *light = contrast as f32;
        }
    }
    Planes { width, height, count: 1, samples: Samples::Float(light) }
}

/// The sun of the built-in sunset, half a degree up: the sky's and the sea's luminances about it,
/// roughly.
fn low_sun(width: usize, offset: f64) -> (Planes, f64) {
    let (height, degrees) = (width * 9 / 16, 8.0 / width as f64);
    let middle = |n: usize| (n as f64 - 1.0) / 2.0;
    let light = |x: usize, y: usize| {
        let r = ((x as f64 - middle(width)) * degrees - offset)
            .hypot((y as f64 - middle(height)) * degrees);
        let sky = 200.0 + 1500.0 * (-r / 0.6).exp() + 1700.0 * (-r / 1.9).exp();
        if r < RADIUS { 6.2e5 } else { sky as f32 }
    };
    (picture([width, height], light), degrees)
}

/// Radius of the sun's disc, degrees.
const RADIUS: f64 = 0.2665;

#[test]
fn a_uniform_picture_is_unchanged() {
    for depth in DEPTHS {
        let mut optics = Optics::at_depth(&cie(), [131, 77], 0.05, 1, depth).unwrap().unwrap();
        for light in [3.0f32, 1e-3, 1.6e9] {
            let r = exchanged(&mut optics, &picture([131, 77], |_, _| light), None);
            let most = floats(&r).iter().map(|r| (r / light - 1.0).abs()).fold(0.0, f32::max);
            assert!(most <= 2.0 * f32::EPSILON, "{most:e}");
        }
    }
}

#[test]
fn no_light_is_lost_or_made() {
    let (s, degrees) = low_sun(240, 0.0);
    for (_, psf) in &PSFS[1..] {
        let mut optics =
            optics(&Scatter { psf: *psf, ..cie() }, [s.width, s.height], degrees, 3e-3);
        let sum = |planes: &Planes| floats(planes).iter().map(|v| f64::from(*v)).sum::<f64>();
        let r = exchanged(&mut optics, &s, None);
        assert!((sum(&r) / sum(&s) - 1.0).abs() < 1e-6, "{psf:?}: {}", sum(&r) / sum(&s));
    }
}

/// K s alone: r - s (1 - c).
fn veil(optics: &mut Optics, s: &Planes) -> Vec<f64> {
    let r = exchanged(optics, s, None);
    let veil =
        |((r, s), kept): ((&f32, &f32), &f32)| f64::from(*r) - f64::from(*s) * f64::from(*kept);
    floats(&r).iter().zip(floats(s)).zip(optics.kept()).map(veil).collect()
}

#[test]
fn scatter_is_symmetric_and_linear_and_black_stays_black() {
    let (size, mut noise) = ([97, 64], Noise(3));
    let mut optics = optics(&cie(), size, 0.04, 3e-3);
    let [a, b] = [0, 1].map(|_| picture(size, |_, _| 0.0)).map(|mut p| {
        let Samples::Float(v) = &mut p.samples else { unreachable!() };
        v.iter_mut().for_each(|v| *v = noise.next() as f32);
        p
    });
    let (ka, kb) = (veil(&mut optics, &a), veil(&mut optics, &b));
    let dot = |a: &Planes, k: &[f64]| {
        floats(a).iter().zip(k).map(|(a, k)| f64::from(*a) * k).sum::<f64>()
    };
    assert!((dot(&a, &kb) / dot(&b, &ka) - 1.0).abs() < 1e-6);
    let both = picture(size, |x, y| (2.0 * a.at(x, y, 0) + 3.0 * b.at(x, y, 0)) as f32);
    for ((both, a), b) in veil(&mut optics, &both).into_iter().zip(ka).zip(kb) {
        assert!((both / (2.0 * a + 3.0 * b) - 1.0).abs() < 3e-6);
    }
    assert!(
        floats(&exchanged(&mut optics, &picture(size, |_, _| 0.0), None)).iter().all(|r| *r == 0.0)
    );
}

#[test]
fn light_stays_between_its_least_and_greatest_and_reaches_every_place() {
    let mut noise = Noise(5);
    for _ in 0..100 {
        let size = [1 + noise.below(60), 1 + noise.below(60)];
        let psf = PSFS[1 + noise.below(5)].1;
        let Some(mut optics) = Optics::at_depth(
            &Scatter { psf, ..cie() },
            size,
            0.2 * noise.next() + 0.01,
            1,
            DEPTHS[noise.below(4)],
        )
        .unwrap() else {
            unreachable!("every function but none scatters")
        };
        let mut s = scene(&mut noise, size, 1e7);
        let Samples::Float(light) = &mut s.samples else { unreachable!() };
        if noise.next() < 0.5 {
            light.iter_mut().for_each(|v| *v = if *v < 30.0 { 0.0 } else { *v });
        }
        let (least, most) =
            light.iter().fold((f32::MAX, 0.0f32), |(a, b), v| (a.min(*v), b.max(*v)));
        let r = exchanged(&mut optics, &s, None);
        for r in floats(&r) {
            assert!(*r >= least * (1.0 - 2e-6) && *r <= most * (1.0 + 2e-6), "{least} {r} {most}");
            assert!(*r > 0.0 || most == 0.0);
        }
    }
}

/// The bound is for light that is not negative; a negative plane of RGB is scattered like its
/// opposite.
#[test]
fn negative_light_is_kept() {
    let (s, degrees) = low_sun(120, 0.0);
    let mut optics = optics(&cie(), [s.width, s.height], degrees, 3e-3);
    let r = exchanged(&mut optics, &s, None);
    let opposite = picture([s.width, s.height], |x, y| -s.at(x, y, 0) as f32);
    assert!(
        floats(&exchanged(&mut optics, &opposite, None))
            .iter()
            .zip(floats(&r))
            .all(|(a, b)| *a == -*b)
    );
}

#[test]
fn one_point_of_light_has_a_round_veil_wherever_it_lies() {
    let (scatter, degrees) = (cie(), 1.0 / 48.0);
    let mut optics = optics(&scatter, [256, 256], degrees, 3e-3);
    let sum = scatter.gaussians(degrees, 362.0);
    for (least, most, radius) in
        [(0.9955, 1.0045, 4.0), (0.9985, 1.0015, 12.0), (0.9985, 1.0015, 48.0)]
    {
        for phase in 0..8 {
            let [px, py] = [128 + phase, 128 + 3 * phase % 8];
            let s = picture([256, 256], |x, y| if [x, y] == [px, py] { 1.0 } else { 0.0 });
            let r = exchanged(&mut optics, &s, None);
            for (x, y) in (0..256 * 256).map(|i| (i % 256, i / 256)) {
                let distance = (x as f64 - px as f64).hypot(y as f64 - py as f64);
                if (distance - radius).abs() < 0.5 {
                    let found = r.at(x, y, 0) / sum.density(distance);
                    assert!((least..most).contains(&found), "{distance} pixels: {found}");
                }
            }
        }
    }
}

#[test]
fn a_turned_picture_has_the_turned_veil() {
    let (s, degrees) = low_sun(240, 0.9);
    let [width, height] = [s.width, s.height];
    let mut optics = optics(&cie(), [width, height], degrees, 3e-3);
    let r = exchanged(&mut optics, &s, None);
    let turned = picture([width, height], |x, y| s.at(width - 1 - x, height - 1 - y, 0) as f32);
    let turned = exchanged(&mut optics, &turned, None);
    for (a, b) in floats(&r).iter().zip(floats(&turned).iter().rev()) {
        assert!((a / b - 1.0).abs() < 1e-3);
    }
}

#[test]
fn a_surround_like_the_picture_leaves_it_and_a_dark_one_takes_light_at_the_border() {
    let size = [160, 90];
    let uniform = picture(size, |_, _| 7.0);
    for (_, psf) in &PSFS[1..] {
        let mut optics = optics(&Scatter { psf: *psf, ..cie() }, size, 0.05, 3e-3);
        let r = exchanged(&mut optics, &uniform, Some(&[7.0]));
        assert!(floats(&r).iter().all(|r| (r / 7.0 - 1.0).abs() < 1e-5), "{psf:?}");
        let r = exchanged(&mut optics, &uniform, Some(&[0.0]));
        let (corner, middle) = (r.at(0, 0, 0), r.at(80, 45, 0));
        assert!(corner < middle && middle < 7.0, "{psf:?}: {corner} {middle}");
    }
}

/// What a neutral filter does to bands it does to their projections.
#[test]
fn scatter_and_projection_commute() {
    let (size, mut noise) = ([64, 36], Noise(9));
    let bands: Vec<f32> = (0..64 * 36 * 8).map(|_| noise.next() as f32).collect();
    let bands = Planes { width: 64, height: 36, count: 8, samples: Samples::Float(bands) };
    let weights: Vec<f64> = (0..8).map(|i| 0.2 + f64::from(i) * 0.1).collect();
    let projected = |planes: &Planes| {
        picture(size, |x, y| {
            weights.iter().enumerate().map(|(i, w)| w * planes.at(x, y, i)).sum::<f64>() as f32
        })
    };
    let mut optics = optics(&cie(), size, 0.1, 3e-3);
    let [one, other] = [
        projected(&exchanged(&mut optics, &bands, None)),
        exchanged(&mut optics, &projected(&bands), None),
    ];
    assert!(floats(&one).iter().zip(floats(&other)).all(|(a, b)| (a / b - 1.0).abs() < 1e-5));
}

#[test]
fn halves_are_scattered_like_the_floats_that_they_are() {
    let mut noise = Noise(2);
    let halves: Vec<f16> = (0..3 * 50 * 40).map(|_| f16::from_f64(100.0 * noise.next())).collect();
    let whole = Samples::Float(halves.iter().map(|h| h.to_f32()).collect());
    let planes = |samples| Planes { width: 50, height: 40, count: 3, samples };
    let mut optics = optics(&cie(), [50, 40], 0.05, 3e-3);
    let [a, b] = [Samples::Half(halves), whole]
        .map(|samples| exchanged(&mut optics, &planes(samples), None));
    assert_eq!(a, b);
}

#[test]
fn straylight_is_a_factor_on_the_veil_and_what_would_scatter_all_light_is_refused() {
    let (s, degrees) = low_sun(120, 0.0);
    let size = [s.width, s.height];
    let with =
        |straylight: f64| Optics::new(&Scatter { straylight, ..cie() }, size, degrees, 1, 3e-3);
    let [mut one, mut two] = [1.0, 2.0].map(|straylight| with(straylight).unwrap().unwrap());
    for (one, two) in veil(&mut one, &s).into_iter().zip(veil(&mut two, &s)) {
        assert!((two / one / 2.0 - 1.0).abs() < 3e-6);
    }
    assert!(with(0.0).unwrap().is_none());
    let told = with(10.0).unwrap_err();
    assert!(
        told.starts_with("found 10, which scatters") && told.contains("accepted: 0 to 2."),
        "{told}"
    );
}

#[test]
fn the_budget_chooses_the_coarsest_depth_that_keeps_it() {
    let bounds = |budget| optics(&cie(), [480, 270], 8.0 / 480.0, budget).bound();
    let [coarse, fine, finest] = [1e-2, 3e-3, 1e-12].map(bounds);
    assert!(fine < coarse && coarse <= 1e-2 && fine <= 3e-3 && finest < fine && finest > 1e-12);
}
