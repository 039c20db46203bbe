//! The paper's model, Eq. 1 to 7, written out once more from the published tables alone, beside
//! preset `paper` with `model = "steady"`. Nothing of the library's science is used on this side:
//! only the files in `data/`.

use std::collections::BTreeMap;
use std::path::Path;

use sungaze::colour::Primaries;
use sungaze::config::Config;
use sungaze::frames::{About, Compression, write_exr};
use sungaze::light::{Planes, Samples};
use sungaze::observer::{
    Adapting, Directional, Field, Narrowing, Observer, Reading, Rule, Set, Steepness,
};
use sungaze::run::{self, Existing, Unwatched};
use sungaze::spectrum::Curve;
use sungaze::units::{Millimetres, Nits};
use sungaze::vision::{Vision, level_bound};

const NM: std::ops::RangeInclusive<usize> = 390..=830;
const WIDTH: usize = 7;
const HEIGHT: usize = 5;
const PIXELS_PER_DEGREE: f64 = 1.0;

/// A column of a table in `data/`, by wavelength.
fn column(file: &str, name: &str) -> BTreeMap<usize, f64> {
    let text = std::fs::read_to_string(format!("data/{file}")).expect("a table");
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let at = lines.next().expect("names").split(',').position(|n| n == name).expect("the column");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (cells[0].parse::<f64>().expect("nm") as usize, cells[at].parse().unwrap_or(f64::NAN))
    };
    lines.map(row).collect()
}

/// Straight lines between the entries of a table; its ends go on.
fn between(table: &BTreeMap<usize, f64>, nm: usize) -> f64 {
    match (table.range(..=nm).next_back(), table.range(nm..).next()) {
        (Some((&a, &x)), Some((&b, &y))) if a < b => x + (y - x) * (nm - a) as f64 / (b - a) as f64,
        (_, Some((_, &y))) => y,
        (Some((_, &x)), None) => x,
        (None, None) => unreachable!("a table has entries"),
    }
}

/// All that the paper's model knows of an eye, at every nm.
struct Paper {
    /// l, m, s: Stockman, MacLeod & Johnson 1993.
    cones: [Vec<f64>; 3],
    absorbance: [Vec<f64>; 3],
    /// p(lambda) after Stiles, corrected for the lens.
    steepness: Vec<f64>,
    v: Vec<f64>,
    /// K, lm/W: D65 reads what CIE 1931 says.
    k: f64,
    own_peak: bool,
}

/// What the straight line finds at one pixel.
struct Place {
    trolands: [f64; 3],
    bleached: [f64; 3],
    catch: [f64; 3],
}

impl Paper {
    fn new(own_peak: bool) -> Paper {
        let [x, y, z] = ["x10", "y10", "z10"].map(|name| column("cie1964_10deg.csv", name));
        let form = |a: f64, b: f64, c: f64| -> Vec<f64> {
            NM.map(|nm| (a * x[&nm] + b * y[&nm] + c * z[&nm]).max(0.0)).collect()
        };
        let l = form(0.236157, 0.826427, -0.045710);
        let m = form(-0.431117, 1.206922, 0.090020);
        let mut s = form(0.040557, -0.019683, 0.486195);
        for nm in NM.filter(|&nm| nm > 520) {
            s[nm - 390] = 10f64.powf(10402.1 / nm as f64 - 21.7185);
        }
        let v: Vec<f64> = (0..l.len())
            .map(|i| 0.67255343 * l[i] + 0.36795030 * m[i] - 0.00489612 * s[i])
            .collect();
        let absorbance = ["l", "m", "s"].map(|cone| {
            let log = column("cone_pieces.csv", &format!("log10_absorbance_{cone}"));
            NM.map(|nm| 10f64.powf(log[&nm])).collect()
        });
        let (stiles, lens) =
            (column("stiles_crawford.csv", "p"), column("cone_pieces.csv", "lens_density"));
        let steepness = NM.map(|nm| between(&stiles, nm) + 0.037 * lens[&nm]).collect();
        let y = column("cie1931_2deg.csv", "y");
        let y: Vec<f64> = NM.map(|nm| y[&nm]).collect();
        let k = 683.002 * dot(&d65(), &y) / dot(&d65(), &v);
        Paper { cones: [l, m, s], absorbance, steepness, v, k, own_peak }
    }

    fn luminance(&self, light: &[f64]) -> f64 {
        self.k * light.iter().zip(&self.v).map(|(e, v)| e * v).sum::<f64>()
    }

    /// Fundamental of a cone whose bleached fraction is b: narrowed by its own pigment, optical
    /// density 0.30.
    fn narrowed(&self, k: usize, b: f64) -> Vec<f64> {
        let absorbed = |a: f64, p: f64| 1.0 - 10f64.powf(-0.30 * p * a);
        let pairs = self.cones[k].iter().zip(&self.absorbance[k]);
        let whole: Vec<f64> =
            pairs.map(|(s, &a)| s * absorbed(a, 1.0 - b) / absorbed(a, 1.0)).collect();
        // The printed coefficients leave the whole pigment's own peak up to 2e-4 from 1: that is no
        // narrowing.
        let greatest = |curve: &[f64]| curve.iter().copied().fold(0.0, f64::max);
        let peak = if self.own_peak { greatest(&whole) / greatest(&self.cones[k]) } else { 1.0 };
        whole.iter().map(|s| s / peak).collect()
    }

    /// A frame of spectra through Eq. 1 to 7; the gaze is the middle pixel.
    fn frame(&self, lights: &[Vec<f64>]) -> (f64, Vec<Place>) {
        let from_gaze = |i: usize| {
            ((i % WIDTH) as f64 - 3.0).hypot((i / WIDTH) as f64 - 2.0) / PIXELS_PER_DEGREE
        };
        let fovea: Vec<f64> = lights
            .iter()
            .enumerate()
            .filter(|&(i, _)| from_gaze(i) <= 1.0)
            .map(|(_, l)| self.luminance(l))
            .collect();
        let adapting = fovea.iter().sum::<f64>() / fovea.len() as f64;
        let d = (4.9 - 3.0 * (0.4 * (adapting.log10() + 1.0)).tanh()).clamp(2.0, 8.0); // Eq. 3
        let area = std::f64::consts::PI * d * d / 4.0;
        let place = |(i, light): (usize, &Vec<f64>)| {
            let r = (0.29 * from_gaze(i)).min(d / 2.0);
            let mut found = Place { trolands: [0.0; 3], bleached: [0.0; 3], catch: [0.0; 3] };
            for k in 0..3 {
                let c = self.v.iter().sum::<f64>() / self.cones[k].iter().sum::<f64>();
                let weighted = light.iter().zip(&self.cones[k]).zip(&self.steepness);
                let integral: f64 =
                    weighted.map(|((e, s), p)| e * 10f64.powf(-p * r * r) * s).sum(); // Eq. 5 to 7
                let td = self.k * c * area * integral; // Eq. 2
                let b = td / (td + 10f64.powf(3.89)); // Eq. 1
                let seen = self.narrowed(k, b);
                found.trolands[k] = td;
                found.bleached[k] = b;
                found.catch[k] = self.k * light.iter().zip(&seen).map(|(e, s)| e * s).sum::<f64>();
            }
            found
        };
        (d, lights.iter().enumerate().map(place).collect())
    }

    /// Linear sRGB in cd/m2 -> catches: the CIE 1964 matrix of the set, X and Z scaled so that D65
    /// falls on .3127, .3290.
    fn of_srgb(&self) -> [[f64; 3]; 3] {
        let to_xyz = [
            [0.4123907993, 0.3575843394, 0.1804807884],
            [0.2126390059, 0.7151686788, 0.0721923154],
            [0.0193308187, 0.1191947798, 0.9505321522],
        ];
        let of_lms = [
            [1.85618309, -1.26433791, 0.40860525],
            [0.67255343, 0.36795030, -0.00489612],
            [-0.12761001, 0.12036347, 2.02250502],
        ];
        let from_xyz = [
            [0.236157, 0.826427, -0.045710],
            [-0.431117, 1.206922, 0.090020],
            [0.040557, -0.019683, 0.486195],
        ];
        let d65 = d65();
        let lms = self.cones.each_ref().map(|s| dot(&d65, s));
        let [x, y, z] = of_lms.map(|row| dot(&row, &lms));
        let scales = [0.3127 / 0.3290 * y / x, 1.0, 0.3583 / 0.3290 * y / z];
        from_xyz
            .map(|row| [0, 1, 2].map(|j| (0..3).map(|i| row[i] / scales[i] * to_xyz[i][j]).sum()))
    }
}

/// D65 at every nm, to the end of its table.
fn d65() -> Vec<f64> {
    let table = column("d65.csv", "d65");
    NM.map(|nm| if nm <= 780 { between(&table, nm) } else { 0.0 }).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Three frames that brighten, redder toward one corner: the pupil closes from 3.6 mm almost to 2
/// mm, where the corner lies beyond its edge. The samples are what a float file holds.
fn frames() -> Vec<Vec<Vec<f64>>> {
    let light = |frame: usize, i: usize| -> Vec<f64> {
        let (x, y) = ((i % WIDTH) as f64, (i / WIDTH) as f64);
        let (peak, width) = (560.0 + 12.0 * x, 60.0 + 10.0 * y);
        let strength = 5e-4 * 30f64.powi(frame as i32) * (1.0 + x * y);
        let at = |nm: usize| strength * (0.05 + (-((nm as f64 - peak) / width).powi(2)).exp());
        NM.map(|nm| f64::from(at(nm) as f32)).collect()
    };
    (0..3).map(|frame| (0..WIDTH * HEIGHT).map(|i| light(frame, i)).collect()).collect()
}

fn settings(narrowing: &str) -> String {
    format!(
        "input = {{ frames = \"f.####.exr\", channels = \"b{{nm}}\", horizontal_fov_deg = 7.0 }}\n\
         observer = {{ preset = \"paper\", narrowing = \"{narrowing}\" }}\n\
         numerics.model = \"steady\"\ntime.fps = 1\n\
         [[output.probe]]\nname = \"corner\"\nat = [0.93, 0.9]\n"
    )
}

fn config(folder: &Path, narrowing: &str) -> Config {
    Config::parse(&settings(narrowing), "test", "test", folder, &[]).expect("a configuration")
}

fn near(ours: f64, straight: f64, share: f64, what: &str) {
    assert!((ours / straight - 1.0).abs() <= share, "{what}: {ours} against {straight}");
}

#[test]
fn preset_paper_is_the_observer_of_the_paper_until_a_key_says_otherwise() {
    let parse = |toml: &str| {
        Config::parse(toml, "test", "test", Path::new(""), &[]).expect("a configuration")
    };
    let paper = parse("observer.preset = \"paper\"").settings.observer;
    assert_eq!(paper.fundamentals, Set::Smj1993);
    assert_eq!(paper.pupil, Rule::MoonSpencerAsPrinted);
    assert!(matches!(paper.stiles_crawford, Reading::Paper { .. }));
    assert_eq!(paper.stiles_crawford_p, Steepness::LensCorrected);
    assert_eq!((paper.half_bleach_log_td, paper.tau_s), ([3.89; 3], [120.0; 3]));
    assert_eq!(paper.narrowing, Narrowing::Narrowed);
    let other = parse(
        "observer = { preset = \"paper\", constants = \"hollins-alpern\", tau_s = [1, 2, 3] }",
    )
    .settings
    .observer;
    assert_eq!((other.half_bleach_log_td, other.tau_s), ([4.3, 4.3, 5.0], [1.0, 2.0, 3.0]));
    assert_eq!(other.fundamentals, Set::Smj1993);
}

#[test]
fn s_cones_that_lose_half_of_their_pigment_are_told_of_with_time_and_share() {
    let folder = tempfile::tempdir().expect("a folder");
    write_frames(folder.path());
    let out = folder.path().join("out");
    let report = run::run(&config(folder.path(), "depleted"), &out, Existing::Refuse, &Unwatched)
        .expect("a run")
        .report;
    let paper = Paper::new(false);
    let past_half = |lights: &Vec<Vec<f64>>| {
        paper.frame(lights).1.iter().filter(|p| p.bleached[2] > 0.5).count()
    };
    let counts: Vec<usize> = frames().iter().map(past_half).collect();
    let first = counts.iter().position(|&n| n > 0).expect("some frame bleaches S by half");
    let share = 100.0 * *counts.last().expect("frames") as f64 / (WIDTH * HEIGHT) as f64;
    let told = report["warnings"].to_string();
    let expected =
        format!("from {:.3} s on, over up to {share:.2} % of the retina", (first + 1) as f64);
    assert!(told.contains(&expected), "{told} lacks {expected}");
}

#[test]
fn the_library_in_full_precision_is_equations_1_to_7_frame_by_frame() {
    for (narrowing, own_peak) in [("narrowed", true), ("depleted", false)] {
        let config = config(Path::new(""), narrowing);
        let (eye, pigments, paper) = (config.observer(), config.pigments(), Paper::new(own_peak));
        for lights in frames() {
            let (d, places) = paper.frame(&lights);
            let curves: Vec<Curve> = lights.iter().map(|light| Curve(light.clone())).collect();
            let pupil = eye.pupil.diameter(foveal(&eye, &curves));
            near(pupil.0, d, 1e-9, "pupil");
            for (i, (curve, place)) in curves.iter().zip(&places).enumerate() {
                let degrees =
                    ((i % WIDTH) as f64 - 3.0).hypot((i / WIDTH) as f64 - 2.0) / PIXELS_PER_DEGREE;
                let r = Millimetres(
                    degrees * eye.directional.mm_per_degree().expect("the paper's reading"),
                );
                let td = eye.illuminance(curve, pupil, r);
                let p = [0, 1, 2].map(|k: usize| pigments[k].steady(td[k]));
                let catch = eye.catch(curve, p);
                for k in 0..3 {
                    near(td[k].0, place.trolands[k], 1e-9, "trolands");
                    near(1.0 - p[k], place.bleached[k], 1e-9, "bleached");
                    near(catch[k], place.catch[k], 1e-9, "catch");
                }
            }
        }
    }
}

/// The mean luminance within a degree of the middle pixel.
fn foveal(eye: &Observer, curves: &[Curve]) -> Adapting {
    let v = eye.luminous_efficiency();
    let inside = |i: usize| (i % WIDTH).abs_diff(3).pow(2) + (i / WIDTH).abs_diff(2).pow(2) <= 1;
    let nits: Vec<f64> = (0..curves.len())
        .filter(|&i| inside(i))
        .map(|i| eye.lumens_per_watt * curves[i].times(&v).integral())
        .collect();
    assert_eq!(eye.pupil, Rule::MoonSpencerAsPrinted);
    let mean = Nits(nits.iter().sum::<f64>() / nits.len() as f64);
    Adapting { fovea: mean, picture: mean, area_deg2: 1.0, surround: Nits(0.0) }
}

/// Writes the frames as spectral pictures of 441 bands of 1 nm.
fn write_frames(folder: &Path) {
    let names: Vec<String> = NM.map(|nm| format!("b{nm}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    for (n, lights) in frames().iter().enumerate() {
        let band =
            |y: usize, band: usize| (0..WIDTH).map(move |x| lights[y * WIDTH + x][band] as f32);
        let samples =
            (0..HEIGHT).flat_map(|y| (0..names.len()).flat_map(move |i| band(y, i))).collect();
        let planes = Planes {
            width: WIDTH,
            height: HEIGHT,
            count: names.len(),
            samples: Samples::Float(samples),
        };
        let path = folder.join(format!("f.{:04}.exr", n + 1));
        write_exr(&path, &names, &planes, Compression::Zip, &About::default()).expect("a frame");
    }
}

#[test]
fn a_run_of_the_paper_is_equations_1_to_7_within_the_bound_of_its_levels() {
    for (narrowing, own_peak) in [("narrowed", true), ("depleted", false)] {
        let folder = tempfile::tempdir().expect("a folder");
        write_frames(folder.path());
        let out = folder.path().join("out");
        run::run(&config(folder.path(), narrowing), &out, Existing::Refuse, &Unwatched)
            .expect("a run");
        let paper = Paper::new(own_peak);
        let probes = std::fs::read_to_string(out.join("probes.csv")).expect("probes");
        for (n, lights) in frames().iter().enumerate() {
            let (_, places) = paper.frame(lights);
            let seen = seen(&out.join(format!("seen.{:04}.exr", n + 1)));
            for (rgb, place) in seen.iter().zip(&places) {
                for (row, catch) in paper.of_srgb().iter().zip(place.catch) {
                    let ours: f64 = row.iter().zip(rgb).map(|(c, v)| c * v).sum();
                    near(ours, catch, level_bound(0.5) + 2e-5, "catch");
                }
            }
            // The corner is pixel (6, 4): I and p come through the levels of the Stiles-Crawford
            // weight, 1e-5.
            let row: Vec<f64> =
                probes.lines().nth(n + 1).expect("a row").split(',').skip(3).map(number).collect();
            let corner = &places[4 * WIDTH + 6];
            for k in 0..3 {
                near(row[k], corner.trolands[k], 1.1e-5, "probe's trolands");
                near(1.0 - row[3 + k], corner.bleached[k], 1.1e-5, "probe's bleached fraction");
            }
        }
    }
}

fn number(cell: &str) -> f64 {
    cell.parse().expect("a number")
}

/// The pixels of a percept, linear sRGB in cd/m2.
fn seen(path: &Path) -> Vec<[f64; 3]> {
    let options = sungaze::frames::ReadOptions::default();
    let planes = sungaze::frames::open(&[path.to_owned()], &options)
        .expect("a file")
        .read(0, None, None)
        .expect("pixels");
    let at = |i: usize| [0, 1, 2].map(|c| planes.planes.at(i % WIDTH, i / WIDTH, c));
    (0..WIDTH * HEIGHT).map(at).collect()
}

#[test]
fn bleaching_begins_without_a_step_in_either_narrowing_of_any_set() {
    let sets = [
        (Set::Cie2006, Field::TenDegrees),
        (Set::Cie2006, Field::TwoDegrees),
        (Set::Smj1993, Field::TenDegrees),
    ];
    for ((set, field), narrowing) in sets.into_iter().flat_map(|set| {
        [Narrowing::Depleted, Narrowing::Narrowed].map(|narrowing| (set, narrowing))
    }) {
        let directional = Directional::new(Reading::Off, Steepness::Measured);
        let observer =
            Observer::new(set, field, set.optical_density(field), narrowing, directional);
        let vision = Vision::of_rgb(observer, &Primaries::REC709, Nits(1.0)).unwrap();
        let pixel =
            Planes { width: 1, height: 1, count: 3, samples: Samples::Float(vec![0.9, 0.5, 0.2]) };
        let moments = vision.moments(&pixel, 0, 0);
        let [whole, bleached] = [1.0, 1.0 - 1e-9].map(|p| vision.catch(&moments, [p; 3]));
        for k in 0..3 {
            assert!(
                (bleached[k] / whole[k] - 1.0).abs() < 1e-8,
                "{set:?} {field:?} {narrowing:?} {k}"
            );
        }
    }
}
