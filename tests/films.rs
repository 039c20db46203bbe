//! Films, made by ffmpeg out of known codes. Without ffmpeg these tests say so and pass.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use sungaze::colour::Primaries;
use sungaze::config::Config;
use sungaze::frames::{Footage, Kind, ReadOptions, Transfer, open, write_png};
use sungaze::light::Samples;

fn has_ffmpeg() -> bool {
    let found = Command::new("ffmpeg").arg("-version").stdout(Stdio::null()).status().is_ok();
    if !found {
        eprintln!("skipped: there is no ffmpeg on PATH");
    }
    found
}

/// A lossless film of raw frames, with what ffmpeg is to be told of them.
fn film(folder: &Path, name: &str, raw: &[u8], input: &[&str], output: &[&str]) -> PathBuf {
    let path = folder.join(name);
    let mut child = Command::new("ffmpeg")
        .args(["-v", "error", "-y", "-f", "rawvideo"])
        .args(input)
        .args(["-i", "-", "-c:v", "ffv1"])
        .args(output)
        .arg(&path)
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(raw).unwrap();
    assert!(child.wait().unwrap().success());
    path
}

fn opened(path: &Path, peak: Option<f64>) -> Box<dyn Footage> {
    opened_as(path, &ReadOptions { peak_cd_m2: peak, ..ReadOptions::default() })
}

fn opened_as(path: &Path, options: &ReadOptions) -> Box<dyn Footage> {
    open(&[path.to_owned()], options).unwrap_or_else(|error| panic!("{error}"))
}

/// Grey frames of one 8-bit code each, 16 x 8 pixels.
fn greys(codes: &[u8]) -> Vec<u8> {
    codes.iter().flat_map(|&code| [vec![code; 128], vec![128; 64]].concat()).collect()
}

const GREY: [&str; 6] = ["-pix_fmt", "yuv420p", "-s", "16x8", "-r", "10"];
const SDR: [&str; 8] = [
    "-color_range",
    "tv",
    "-colorspace",
    "bt709",
    "-color_primaries",
    "bt709",
    "-color_trc",
    "bt709",
];

/// SMPTE ST 2084 as it is printed.
fn st2084(signal: f64) -> f64 {
    let (m1, m2) = (0.159_301_757_812_5, 78.843_75);
    let (c1, c2, c3) = (0.835_937_5, 18.851_562_5, 18.687_5);
    let e = signal.clamp(0.0, 1.0).powf(1.0 / m2);
    10_000.0 * ((e - c1).max(0.0) / (c2 - c3 * e)).powf(1.0 / m1)
}

const PATCH: usize = 8;

/// What a half loses of a number, relative: light of up to ten bits is kept in halves.
const HALF: f64 = 1.0 / 2048.0;

/// Patches of luma and chroma codes in `bits`, 4:2:0, and the codes of each in 10 bits.
fn patches(bits: u32) -> (Vec<u8>, Vec<[f64; 3]>) {
    let lumas = (0..48).map(|i| 64 + i * 876 / 47);
    let chromas = [(512, 512), (512, 700), (600, 420), (420, 560)];
    let codes: Vec<[u16; 3]> =
        chromas.iter().flat_map(|&(cb, cr)| lumas.clone().map(move |y| [y, cb, cr])).collect();
    let plane = |i: usize, size: usize| -> Vec<u8> {
        let rows = (0..4 * size).map(|y| y / size);
        let row = |y: usize| (0..48 * size).map(move |x| (y, x / size));
        rows.flat_map(row)
            .flat_map(|(y, x)| (codes[y * 48 + x][i] << (bits - 10)).to_le_bytes())
            .collect()
    };
    let raw = [plane(0, PATCH), plane(1, PATCH / 2), plane(2, PATCH / 2)].concat();
    (raw, codes.iter().map(|codes| codes.map(f64::from)).collect())
}

/// BT.2100: R', G', B' of codes of limited range, BT.2020 primaries.
fn signals([y, cb, cr]: [f64; 3]) -> [f64; 3] {
    let (y, cb, cr) = ((y - 64.0) / 876.0, (cb - 512.0) / 896.0, (cr - 512.0) / 896.0);
    let (r, b) = (y + 1.4746 * cr, y + 1.8814 * cb);
    [r, (y - 0.2627 * r - 0.0593 * b) / 0.6780, b]
}

fn wide(transfer: &str) -> Vec<&str> {
    let range = ["-color_range", "tv", "-colorspace", "bt2020nc", "-color_primaries", "bt2020"];
    [&range[..], &["-color_trc", transfer, "-chroma_sample_location", "left"]].concat()
}

/// The greatest relative error over the middles of all patches where light is above .1 cd/m2.
fn worst(
    bits: u32,
    transfer: &str,
    peak: Option<f64>,
    expected: impl Fn([f64; 3]) -> [f64; 3],
) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let (raw, codes) = patches(bits);
    let layout = format!("yuv420p{bits}le");
    let input = ["-pix_fmt", &layout, "-s", "384x32", "-r", "24"];
    let path = film(folder.path(), "a.mkv", &raw, &input, &wide(transfer));
    let footage = opened(&path, peak);
    let Kind::Rgb(primaries) = footage.header().kind else { panic!("not RGB") };
    assert_eq!(primaries.red, [0.708, 0.292]);
    let white = footage.header().white.unwrap().0;
    let planes = footage.read(0, None, None).unwrap().planes;
    let mut worst: f64 = 0.0;
    for (i, &codes) in codes.iter().enumerate() {
        // Beyond 109 % there is no code of any one channel, and the reader stops.
        if signals(codes).into_iter().any(|signal| signal > 1.09) {
            continue;
        }
        let (x, y) = (i % 48 * PATCH + PATCH / 2, i / 48 * PATCH + PATCH / 2);
        for (plane, light) in expected(codes).into_iter().enumerate() {
            let found = planes.at(x, y, plane) * white;
            if light > 0.1 {
                worst = worst.max((found / light - 1.0).abs());
            }
        }
    }
    worst
}

#[test]
fn pq_patches_come_out_as_st_2084_has_them() {
    if has_ffmpeg() {
        for (bits, within) in [(10, HALF + 1e-4), (12, 1e-4)] {
            let error = worst(bits, "smpte2084", None, |codes| signals(codes).map(st2084));
            assert!(error < within, "{bits} bits: {error}");
        }
    }
}

#[test]
fn hlg_and_bt1886_patches_come_out_for_their_peak() {
    if !has_ffmpeg() {
        return;
    }
    let gamma = 1.2 + 0.42 * (600.0f64 / 1000.0).log10();
    let hlg = |codes| {
        let scene = signals(codes).map(|e: f64| match e.max(0.0) {
            e if e <= 0.5 => e * e / 3.0,
            e => (((e - 0.55991073) / 0.17883277).exp() + 0.28466892) / 12.0,
        });
        let y = 0.2627 * scene[0] + 0.6780 * scene[1] + 0.0593 * scene[2];
        scene.map(|light| 600.0 * y.powf(gamma - 1.0) * light)
    };
    let error = worst(10, "arib-std-b67", Some(600.0), hlg);
    assert!(error < 1e-3, "{error}");
    let bt1886 = |codes| signals(codes).map(|signal| 100.0 * signal.max(0.0).powf(2.4));
    let error = worst(10, "bt2020-10", Some(100.0), bt1886);
    assert!(error < 1e-3, "{error}");
}

#[test]
fn frames_are_found_in_any_order_and_a_damaged_one_is_named() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let codes: Vec<u8> = (0..12).map(|i| 30 + 15 * i).collect();
    let checked = [&SDR[..], &["-slicecrc", "1", "-level", "3", "-g", "1"]].concat();
    let path = film(folder.path(), "a.mkv", &greys(&codes), &GREY, &checked);
    let footage = opened(&path, Some(100.0));
    assert_eq!(footage.len(), 12);
    let value = |i: usize| footage.read(i, None, None).unwrap().planes.at(3, 4, 1);
    for i in [0, 5, 5, 2, 11, 3] {
        let expected = (f64::from(codes[i]) - 16.0) / 219.0;
        assert!((value(i) - expected.powf(2.4)).abs() < 0.5 * HALF, "{i}");
    }
    let mut bytes = std::fs::read(&path).unwrap();
    let length = bytes.len();
    std::fs::write(folder.path().join("cut.mkv"), &bytes[..length * 2 / 3]).unwrap();
    let cut = open(&[folder.path().join("cut.mkv")], &ReadOptions::default());
    assert!(cut.map(|_| ()).unwrap_err().to_string().contains("cut.mkv: is cut short"));
    // Size and place of the packet of the seventh frame.
    let told = Command::new("ffprobe")
        .args(["-v", "error", "-show_entries", "packet=size,pos", "-of", "csv=p=0"])
        .arg(&path)
        .output()
        .unwrap();
    let told = String::from_utf8(told.stdout).unwrap();
    let packet: Vec<usize> =
        told.lines().nth(6).unwrap().split(',').map(|number| number.parse().unwrap()).collect();
    bytes[packet[1] + packet[0] / 2] ^= 0x55;
    std::fs::write(&path, bytes).unwrap();
    let footage = opened(&path, Some(100.0));
    let error = (0..12).find_map(|i| footage.read(i, None, None).err()).unwrap().to_string();
    let named = error.contains("a.mkv: is damaged or cut short at frame");
    assert!(named && error.contains("CRC mismatch"), "{error}");
}

/// One frame of random codes in one layout, as ffmpeg's raw video in Matroska.
fn packed(folder: &Path, pix_fmt: &str, range: &str, raw: &[u8]) -> PathBuf {
    let input = ["-pix_fmt", pix_fmt, "-s", "16x8", "-r", "10", "-color_range", range];
    let output = ["-c:v", "rawvideo", "-allow_raw_vfw", "1"];
    film(
        folder,
        "packed.mkv",
        raw,
        &input,
        &[&output[..], &SDR[2..], &["-color_range", range]].concat(),
    )
}

#[test]
fn packed_layouts_hold_the_light_of_the_same_codes_in_planes_whatever_their_range() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let code = |i: usize| (i * 7919 % 251) as u8;
    let luma: Vec<u8> = (0..128).map(code).collect();
    let (cb, cr): (Vec<u8>, Vec<u8>) = (0..32).map(|i| (code(i + 200), code(i + 300))).unzip();
    let dealt =
        |a: &[u8], b: &[u8]| a.iter().zip(b).flat_map(|(a, b)| [*a, *b]).collect::<Vec<_>>();
    let planar = [&luma[..], &cb, &cr].concat();
    for range in ["tv", "pc"] {
        let light = |raw: &[u8], pix_fmt: &str| {
            let path = packed(folder.path(), pix_fmt, range, raw);
            opened(&path, Some(100.0)).read(0, None, None).unwrap().planes
        };
        let expected = light(&planar, "yuv420p");
        assert_eq!(light(&[luma.clone(), dealt(&cb, &cr)].concat(), "nv12"), expected, "{range}");
        assert_eq!(light(&[luma.clone(), dealt(&cr, &cb)].concat(), "nv21"), expected, "{range}");
        // 4:2:2: as many samples of chroma as of luma.
        let (cb, cr) = (&planar[..64], &luma[60..124]);
        let expected = light(&[&luma, cb, cr].concat(), "yuv422p");
        let chroma = dealt(cb, cr);
        assert_eq!(light(&dealt(&luma, &chroma), "yuyv422"), expected, "{range}");
        assert_eq!(light(&dealt(&chroma, &luma), "uyvy422"), expected, "{range}");
    }
}

#[test]
fn an_unread_layout_says_what_to_do() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = packed(folder.path(), "rgb555le", "pc", &[0x55; 256]);
    let error = open(&[path], &ReadOptions::default()).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("in the layout `rgb555le`"), "{error}");
    assert!(error.contains("ffmpeg -i FILM -c:v ffv1"), "{error}");
}

/// A film that tells nothing of itself, of one colour in limited BT.2020, PQ.
fn untagged(folder: &Path, [y, cb, cr]: [u8; 3]) -> PathBuf {
    let raw = [vec![y; 128], vec![cb; 32], vec![cr; 32]].concat();
    film(folder, "untagged.mkv", &raw, &["-pix_fmt", "yuv420p", "-s", "16x8"], &[])
}

#[test]
fn keys_stand_for_the_tags_that_a_film_lacks() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (y, cb, cr) = (120.0, 100.0, 170.0);
    let path = untagged(folder.path(), [120, 100, 170]);
    let error = open(std::slice::from_ref(&path), &ReadOptions::default()).map(|_| ()).unwrap_err();
    assert!(error.to_string().contains("say input.transfer"), "{error}");
    let light = |keys: &str| {
        let text = format!("input.frames = \"f\"\ninput.transfer = \"linear\"\n{keys}");
        let config = Config::parse(&text, "keys", "keys", Path::new(""), &[]).unwrap();
        let footage = opened_as(&path, &config.read_options().unwrap());
        let planes = footage.read(0, None, None).unwrap().planes;
        let Kind::Rgb(primaries) = footage.header().kind else { panic!("not RGB") };
        ([0, 1, 2].map(|plane| planes.at(5, 4, plane)), primaries, footage.header().notes.clone())
    };
    // BT.709-6, BT.2020-2 and BT.601-7: 2 (1 - Kr), 2 (1 - Kb), and what they leave of green.
    let expected = |[kr, kb]: [f64; 2], full: bool| {
        let y = if full { y / 255.0 } else { (y - 16.0) / 219.0 };
        let span = if full { 255.0 } else { 224.0 };
        let (cb, cr) = ((cb - 128.0) / span, (cr - 128.0) / span);
        let (r, b) = (y + 2.0 * (1.0 - kr) * cr, y + 2.0 * (1.0 - kb) * cb);
        [r, (y - kr * r - kb * b) / (1.0 - kr - kb), b]
    };
    let weights =
        [("bt601", [0.299, 0.114]), ("bt709", [0.2126, 0.0722]), ("bt2020-ncl", [0.2627, 0.0593])];
    for (name, weights) in weights {
        for (range, full) in [("limited", false), ("full", true)] {
            let keys = format!("input.matrix = \"{name}\"\ninput.code_range = \"{range}\"\n");
            let (found, _, notes) = light(&keys);
            let near =
                found.iter().zip(expected(weights, full)).all(|(a, b)| (a - b).abs() < 0.5 * HALF);
            assert!(near, "{keys}{found:?}");
            assert!(notes.iter().all(|note| !note.contains("matrix") && !note.contains("range")));
        }
    }
    let (_, primaries, notes) = light("input.primaries = \"p3-d65\"");
    assert_eq!(primaries, Primaries::P3_D65);
    assert!(notes.iter().all(|note| !note.contains("primaries")), "{notes:?}");
    let (_, primaries, notes) = light("");
    assert_eq!(primaries, Primaries::REC709);
    for assumed in ["matrix", "range", "primaries"] {
        assert!(notes.iter().any(|note| note.contains(assumed)), "{notes:?}");
    }
}

#[test]
fn keys_go_before_tags_that_are_wrong() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = film(folder.path(), "a.mkv", &greys(&[180]), &GREY, &SDR);
    let value = |options: ReadOptions| {
        let footage = opened_as(&path, &ReadOptions { peak_cd_m2: Some(100.0), ..options });
        footage.read(0, None, None).unwrap().planes.at(3, 3, 1)
    };
    let silent = ReadOptions::default;
    let near = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 0.5 * HALF, "{found} {expected}")
    };
    near(value(silent()), (164.0f64 / 219.0).powf(2.4));
    near(value(ReadOptions { full_range: Some(true), ..silent() }), (180.0f64 / 255.0).powf(2.4));
    near(value(ReadOptions { transfer: Some(Transfer::Linear), ..silent() }), 164.0 / 219.0);
    let options = ReadOptions { primaries: Some(Primaries::BT2020), ..silent() };
    assert_eq!(opened_as(&path, &options).header().kind, Kind::Rgb(Primaries::BT2020));
}

/// Exit code and message of a run of `a.mkv` with these settings.
fn refused(folder: &Path, frames: &str, sets: &[&str]) -> String {
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    let output = program()
        .args(["run", frames, "--fov", "20", "--overwrite", "--out", "o"])
        .args(sets)
        .current_dir(folder)
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    message
}

#[test]
fn a_white_that_the_curve_tells_itself_is_refused() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    film(folder.path(), "a.mkv", &greys(&[90]), &GREY, &SDR);
    let says = |sets: &[&str], words: &[&str]| {
        let message = refused(folder.path(), "a.mkv", sets);
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    let (white, peak) = ("input.white_cd_m2=5000", "input.peak_cd_m2=400");
    says(&["input.transfer=pq", white], &["input.white_cd_m2", "PQ", "leave it out"]);
    says(&["input.transfer=pq", peak], &["input.peak_cd_m2", "PQ", "leave it out"]);
    says(&["input.transfer=hlg"], &["input.peak_cd_m2", "--set input.peak_cd_m2=1000"]);
    says(&["input.transfer=hlg", peak, white], &["input.white_cd_m2", "input.peak_cd_m2"]);
    says(&["input.transfer=linear", peak, white], &["input.peak_cd_m2", "input.white_cd_m2"]);
    says(&[peak, white], &["input.peak_cd_m2", "says the same as input.white_cd_m2"]);
}

#[test]
fn keys_of_codes_are_refused_beside_linear_light_and_those_of_films_beside_stills() {
    let folder = tempfile::tempdir().unwrap();
    write_png(&folder.path().join("a.png"), 2, 1, &[255, 0, 188, 255, 255, 10]).unwrap();
    let message = refused(folder.path(), "a.png", &["input.peak_cd_m2=100", "input.matrix=bt709"]);
    assert!(message.contains("input.matrix") && message.contains("belongs to a film"), "{message}");
    std::fs::write(folder.path().join("a.hdr"), b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80\x80")
        .unwrap();
    for set in ["input.peak_cd_m2=100", "input.transfer=pq"] {
        let message = refused(folder.path(), "a.hdr", &[set, "input.white_cd_m2=100"]);
        assert!(message.contains("belongs to frames made for a display"), "{message}");
    }
}

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_sungaze"))
}

/// Runs a film and gives the rows of trace.csv.
fn traced(folder: &Path, keys: &str) -> Vec<Vec<String>> {
    let config = folder.join("c.toml");
    let text = format!(
        "input.frames = \"a.mkv\"\ninput.horizontal_fov_deg = 20\ninput.peak_cd_m2 = 100\n{keys}"
    );
    std::fs::write(&config, text).unwrap();
    let out = folder.join("o");
    let output = program()
        .args(["run", "--quiet", "--overwrite", "--out"])
        .arg(&out)
        .arg(&config)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows = std::fs::read_to_string(out.join("trace.csv")).unwrap();
    rows.lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect()).collect()
}

/// Codes of 12 bits and less are no finer than halves, and halves take half the room.
#[test]
fn what_is_seen_of_a_film_is_written_in_halves() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    film(folder.path(), "a.mkv", &greys(&[17, 180, 235]), &GREY, &SDR);
    traced(folder.path(), "numerics.model = \"none\"\n");
    for (number, code) in [(1, 17.0), (2, 180.0), (3, 235.0f64)] {
        let path = folder.path().join(format!("o/seen.000{number}.exr"));
        let footage = opened(&path, None);
        let planes = footage.read(0, None, None).unwrap().planes;
        assert!(matches!(planes.samples, Samples::Half(_)));
        let expected = ((code - 16.0) / 219.0).powf(2.4);
        let found = planes.at(3, 3, 0);
        assert!((found - expected).abs() < 6e-8 + 5e-4 * expected, "{found} {expected}");
    }
}

#[test]
fn a_killed_run_of_a_film_is_resumed_to_the_same_bytes() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let codes: Vec<u8> = (0..80).map(|i| 80 + i).collect();
    film(folder.path(), "a.mkv", &greys(&codes), &GREY, &SDR);
    let run = |out: &str, more: &[&str]| {
        let mut command = program();
        command.args(["run", "a.mkv", "--fov", "20", "--quiet", "--out", out]).args(more);
        command.args(["--set", "input.peak_cd_m2=9000", "--set", "output.checkpoint_s=0"]);
        command.current_dir(folder.path());
        command
    };
    assert!(run("whole", &[]).status().unwrap().success());
    // Killed as soon as there is something to go on from, which is long before the last frame.
    let mut killed = run("killed", &[]).spawn().unwrap();
    let checkpoint = folder.path().join("killed/checkpoint.sungaze");
    while !checkpoint.exists() && killed.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(checkpoint.exists(), "it was over before it could be killed");
    assert!(run("killed", &["--resume"]).status().unwrap().success());
    for name in ["probes.csv", "trace.csv", "seen.0080.exr", "display.0080.png", "state.exr"] {
        let bytes = |out: &str| std::fs::read(folder.path().join(out).join(name)).unwrap();
        assert!(bytes("killed") == bytes("whole"), "{name}");
    }
}

/// The most memory that a run of a film of so many frames has held, kB, as Linux counts it.
#[cfg(target_os = "linux")]
fn most_memory(folder: &Path, frames: u8) -> u64 {
    let raw: Vec<u8> = (0..frames).flat_map(|i| vec![60 + i % 100; 320 * 180 * 3 / 2]).collect();
    let input = ["-pix_fmt", "yuv420p", "-s", "320x180", "-r", "24"];
    let path = film(folder, "long.mkv", &raw, &input, &SDR);
    let mut run = program()
        .args(["run", "--fov", "20", "--quiet", "--overwrite", "--set", "input.peak_cd_m2=400"])
        .args(["--set", "output.checkpoint_s=1e9", "--set", "output.range=1", "--out"])
        .arg(folder.join("o"))
        .arg(&path)
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", run.id());
    let mut most = 0;
    while run.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(&status).unwrap_or_default();
        let held = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let held = held.and_then(|held| held.trim().strip_suffix(" kB")?.parse().ok());
        most = most.max(held.unwrap_or(0));
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    assert!(run.wait().unwrap().success());
    most
}

/// A frame's planes are 691 kB: were one kept of each, 220 frames would hold 150 MB more.
#[cfg(target_os = "linux")]
#[test]
fn a_long_film_needs_no_more_memory_than_a_short_one() {
    if has_ffmpeg() {
        let folder = tempfile::tempdir().unwrap();
        let [short, long] = [30, 250].map(|frames| most_memory(folder.path(), frames));
        assert!(short > 1000 && long < short + 16_000, "{short} kB, then {long} kB");
    }
}

#[test]
fn a_film_of_variable_rate_is_seen_at_its_own_times() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let uneven = ["-vf", "select='eq(n,0)+eq(n,3)+eq(n,4)+eq(n,9)'", "-fps_mode", "passthrough"];
    let output = [&SDR[..], &uneven].concat();
    film(folder.path(), "a.mkv", &greys(&[200; 12]), &GREY, &output);
    let column = |rows: &[Vec<String>], i: usize| -> Vec<f64> {
        rows.iter().map(|row| row[i].parse().unwrap()).collect()
    };
    let near = |found: Vec<f64>, expected: &[f64]| {
        let same = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-3);
        assert!(found.len() == expected.len() && same, "{found:?} {expected:?}");
    };
    let rows = traced(folder.path(), "");
    near(column(&rows, 0), &[1.0, 2.0, 3.0, 4.0]);
    near(column(&rows, 1), &[0.3, 0.4, 0.9, 1.0]);
    let rows = traced(folder.path(), "input.range = \"2-4\"\n");
    near(column(&rows, 0), &[2.0, 3.0, 4.0]);
    near(column(&rows, 1), &[0.1, 0.6, 0.7]);
    // Even frames are even, though Matroska rounds them to milliseconds.
    film(
        folder.path(),
        "a.mkv",
        &greys(&[200; 7]),
        &["-pix_fmt", "yuv420p", "-s", "16x8", "-r", "30"],
        &SDR,
    );
    let rows = traced(folder.path(), "");
    assert!(
        column(&rows, 2).iter().all(|duration| (duration * 30.0 - 1.0).abs() < 1e-9),
        "{rows:?}"
    );
    film(folder.path(), "a.mkv", &greys(&[200; 12]), &GREY, &output);
    let rows = traced(folder.path(), "time.fps = 10\n");
    near(column(&rows, 1), &[0.1, 0.2, 0.3, 0.4]);
}

#[test]
fn without_ffmpeg_the_message_says_what_to_install_or_to_run() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("clip.mov"), b"\0\0\0\x14ftypqt  ").unwrap();
    let output = program()
        .args(["inspect", "clip.mov"])
        .current_dir(folder.path())
        .env("PATH", "")
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("apt install ffmpeg"), "{message}");
    assert!(
        message.contains("ffmpeg -i clip.mov -fps_mode passthrough clip.%04d.png"),
        "{message}"
    );
}
