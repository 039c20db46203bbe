//! Values that have the right type and are wrong all the same.

use std::collections::HashSet;

use super::Wrong;
use super::settings::{
    Aim, Channels, DisplayFile, Input, ObserverKeys, Scene, Settings, Times, UnitKey,
};
use crate::eye::Surround;
use crate::observer::{Rule, Set, Steepness, lens};

type Check = Result<(), Wrong>;

/// Checks every key's range and the keys that exclude each other. The first fault is returned.
pub(super) fn check(s: &Settings) -> Check {
    input(s)?;
    time(s)?;
    observer(s)?;
    within("gaze.fovea_deg", s.gaze.fovea_deg, f64::MIN_POSITIVE, 180.0)?;
    if let Surround::Uniform(nits) = s.gaze.surround_cd_m2 {
        within("gaze.surround_cd_m2", nits.0, 0.0, 1e12)?;
    }
    if let Aim::At(at) = s.gaze.at {
        point("gaze.at", at)?;
    }
    within("optics.core_deg", s.optics.core_deg, 0.0, 10.0)?;
    within("optics.straylight", s.optics.straylight, 0.0, 10.0)?;
    within("numerics.light_budget", s.numerics.light_budget, f64::MIN_POSITIVE, 1.0)?;
    within("numerics.budget", s.numerics.budget, f64::MIN_POSITIVE, 1.0)?;
    within("numerics.substeps", f64::from(s.numerics.substeps), 0.0, 1e6)?;
    display(s)?;
    output(s)?;
    probes(s)
}

fn display(s: &Settings) -> Check {
    within("display.exposure_ev", s.display.exposure_ev, -100.0, 100.0)?;
    within("display.white_cd_m2", s.display.white_cd_m2, 1e-6, 1e9)?;
    within("display.highlights", s.display.highlights, 0.0, 1.0)?;
    if s.display.smoothing_s.is_nan() || s.display.smoothing_s < 0.0 {
        return wrong(
            "display.smoothing_s",
            s.display.smoothing_s,
            "0 or more seconds; inf pins the map to the first frame",
        );
    }
    Ok(())
}

fn output(s: &Settings) -> Check {
    within("output.checkpoint_s", s.output.checkpoint_s, 0.0, 1e9)?;
    if s.output.video != "none" && s.output.display == DisplayFile::None {
        return Err((
            "output.video".into(),
            "is made of the display pictures: it needs output.display = \"png\"".into(),
        ));
    }
    let film = std::path::Path::new(&s.output.video);
    let known =
        film.extension().is_some_and(|e| ["mp4", "mkv", "mov"].iter().any(|known| e == *known));
    if s.output.video != "none"
        && (!known || film.file_name() != Some(film.as_os_str()) || s.output.video.starts_with('-'))
    {
        return wrong(
            "output.video",
            &s.output.video,
            "none, or a file name that ends in .mp4, .mkv or .mov",
        );
    }
    Ok(())
}

fn input(s: &Settings) -> Check {
    let input = &s.input;
    if input.scene.is_some() && input.frames.is_some() {
        return Err(("input.frames".into(), "excludes input.scene: give one of the two".into()));
    }
    let beside = of_scenes(input).into_iter().find(|(_, given)| *given && input.frames.is_some());
    if let Some((key, _)) = beside {
        let problem = "belongs to a built-in scene; it has no meaning beside input.frames";
        return Err((key.into(), problem.into()));
    }
    match input.scene {
        None => {}
        Some(Scene::Sunset) => sunset(input)?,
        Some(Scene::Field) => field(s)?,
    }
    optional("input.horizontal_fov_deg", input.horizontal_fov_deg, 1e-3, 360.0)?;
    optional("input.width", input.width.map(f64::from), 1.0, 16384.0)?;
    optional("input.height", input.height.map(f64::from), 1.0, 16384.0)?;
    optional("input.sun_elevation_deg", input.sun_elevation_deg, 0.0, 90.0)?;
    optional("input.turbidity", input.turbidity, 1.0, 10.0)?;
    optional("input.peak_cd_m2", input.peak_cd_m2, 1.0, 1e6)?;
    optional("input.white_cd_m2", input.white_cd_m2, 1e-9, 1e12)?;
    channels(s)?;
    within("input.scale", input.scale, 1e-30, 1e30)?;
    within("input.max_pixels", input.max_pixels as f64, 1.0, 1e12)
}

/// The keys of scenes without a file alone, and whether they are given.
fn of_scenes(input: &Input) -> [(&'static str, bool); 10] {
    [
        ("input.sun_elevation_deg", input.sun_elevation_deg.is_some()),
        ("input.turbidity", input.turbidity.is_some()),
        ("input.horizon", input.horizon.is_some()),
        ("input.height", input.height.is_some()),
        ("input.unit", input.unit.is_some()),
        ("input.spectrum", input.spectrum.is_some()),
        ("input.level", input.level.is_some()),
        ("input.schedule", input.schedule.is_some()),
        ("input.repeat", input.repeat.is_some()),
        ("input.history", input.history.is_some()),
    ]
}

fn sunset(input: &Input) -> Check {
    if let Some((key, _)) = of_scenes(input)[3..].iter().find(|(_, given)| *given) {
        return Err(((*key).into(), "belongs to input.scene = \"field\"".into()));
    }
    if input.horizontal_fov_deg.is_some() {
        return Err((
            "input.horizontal_fov_deg".into(),
            "belongs to input.frames; the built-in sunset is 8 degrees across".into(),
        ));
    }
    optional("input.width", input.width.map(f64::from), 16.0, 16384.0)
}

fn field(s: &Settings) -> Check {
    let input = &s.input;
    if let Some((key, _)) = of_scenes(input)[..3].iter().find(|(_, given)| *given) {
        return Err(((*key).into(), "belongs to input.scene = \"sunset\"".into()));
    }
    optional("input.level", input.level, 0.0, MOST_LIGHT)?;
    for &[seconds, level] in input.schedule.iter().flatten() {
        within("input.schedule", seconds, 1e-9, 1e9)?;
        within("input.schedule", level, 0.0, MOST_LIGHT)?;
    }
    if input.schedule.as_ref().is_some_and(Vec::is_empty) {
        return wrong("input.schedule", "an empty list", "[seconds, level] for each light");
    }
    optional("input.repeat", input.repeat.map(f64::from), 1.0, 1e7)?;
    let alone = |key: &str, problem: &str| Err((key.into(), problem.into()));
    if input.repeat.is_some() && input.schedule.is_none() {
        return alone("input.repeat", "belongs to input.schedule");
    }
    if input.history.is_some() && input.unit == Some(UnitKey::CdM2) {
        return alone("input.unit", "found cd_m2; a history is in td");
    }
    if input.history.is_some() && input.spectrum.is_some() {
        return alone("input.spectrum", "has no meaning beside a history, which gives each cone");
    }
    if input.level.is_none() && (s.time.listed().is_some() || s.time.duration_s.is_some()) {
        let problem = "belongs to a level that stays; a schedule or a history has its own times";
        let key = if s.time.duration_s.is_some() { "time.duration_s" } else { "time.times_s" };
        let timed = input.schedule.is_some() || input.history.is_some();
        return if timed { alone(key, problem) } else { Ok(()) };
    }
    Ok(())
}

/// The most light of a field, td or cd/m2.
const MOST_LIGHT: f64 = 1e20;

fn channels(s: &Settings) -> Check {
    let Some(Channels::Listed(list)) = &s.input.channels else { return Ok(()) };
    if list.is_empty() {
        return wrong(
            "input.channels",
            "an empty list",
            "one { name, centre_nm, width_nm } a band",
        );
    }
    for channel in list {
        within("input.channels.centre_nm", channel.centre_nm, 1.0, 1e5)?;
        within("input.channels.width_nm", channel.width_nm, 1e-3, 1e4)?;
    }
    Ok(())
}

fn time(s: &Settings) -> Check {
    let t = &s.time;
    let given = [
        ("time.fps", t.fps.is_some()),
        ("time.interval_s", t.interval_s.is_some()),
        ("time.times_s", matches!(t.times_s, Some(Times::Listed(_)))),
        ("time.frames_s", t.frames_s.is_some()),
    ];
    let mut ways = given.iter().filter(|(_, given)| *given);
    if let (Some((first, _)), Some((second, _))) = (ways.next(), ways.next()) {
        return Err((
            (*second).into(),
            format!("excludes {first}: give one of the ways to say the frames' times"),
        ));
    }
    optional("time.fps", t.fps, 1e-9, 1e9)?;
    optional("time.interval_s", t.interval_s, 1e-9, 1e9)?;
    optional("time.duration_s", t.duration_s, 1e-9, 1e9)?;
    if t.follows_the_gaze() {
        follows_the_gaze(s)?;
    } else if t.frames_s.is_some() {
        let problem = "belongs to times_s = \"gaze.path\"; elsewhere times_s lists these times";
        return Err(("time.frames_s".into(), problem.into()));
    }
    let key = if t.frames_s.is_some() { "time.frames_s" } else { "time.times_s" };
    t.listed().map_or(Ok(()), |times| rising(key, times))
}

fn rising(key: &str, times: &[f64]) -> Check {
    let wrong = |found: String| wrong(key, found, "seconds that begin at 0 and rise");
    match (times.first(), times.windows(2).find(|w| w[0] >= w[1] || !w[1].is_finite())) {
        (None, _) => wrong("an empty list".into()),
        (Some(&first), _) if first != 0.0 => wrong(format!("{first} at the beginning")),
        (_, Some(pair)) => wrong(format!("{} after {}", pair[1], pair[0])),
        _ => Ok(()),
    }
}

/// Frames end at the rows of the gaze path: it must be there, and say when the last ends.
fn follows_the_gaze(s: &Settings) -> Check {
    if s.gaze.path.is_none() {
        return Err(("time.times_s".into(), "\"gaze.path\" needs a gaze.path".into()));
    }
    if s.time.duration_s.is_some() {
        return Err(("time.duration_s".into(), "excludes time.times_s = \"gaze.path\"".into()));
    }
    Ok(())
}

fn observer(s: &Settings) -> Check {
    let o = &s.observer;
    if ![2, 10].contains(&o.field_deg) {
        return wrong("observer.field_deg", o.field_deg, "2, 10");
    }
    if ![1, 2].contains(&o.eyes) {
        return wrong("observer.eyes", o.eyes, "1, 2");
    }
    match (o.pupil, o.pupil_mm) {
        (Rule::Fixed(_), None) => {
            return Err((
                "observer.pupil_mm".into(),
                "is required with observer.pupil = \"fixed\"".into(),
            ));
        }
        (Rule::Fixed(_), mm) => optional("observer.pupil_mm", mm, 0.1, 8.0)?,
        (_, Some(_)) => {
            return Err((
                "observer.pupil_mm".into(),
                "belongs to observer.pupil = \"fixed\"".into(),
            ));
        }
        (_, None) => {}
    }
    age(o)?;
    within("observer.pigmentation", o.pigmentation, 0.0, 1.2)?;
    within("observer.pupil_delay_s", o.pupil_delay_s, 0.0, 60.0)?;
    within("observer.pupil_closing_s", o.pupil_closing_s, 0.0, 60.0)?;
    within("observer.pupil_opening_s", o.pupil_opening_s, 0.0, 60.0)?;
    if let Steepness::Constant(p) = o.stiles_crawford_p {
        within("observer.stiles_crawford_p", p, 0.0, 1.0)?;
    }
    within("observer.mm_per_degree", o.mm_per_degree, 0.0, 10.0)?;
    within("observer.km", o.km, 0.01, 100.0)?;
    triple("observer.half_bleach_log_td", o.half_bleach_log_td, -3.0, 12.0)?;
    triple("observer.tau_s", o.tau_s, 1e-3, 1e6)?;
    o.optical_density.map_or(Ok(()), |d| triple("observer.optical_density", d, 1e-3, 0.5))
}

/// The lens of `cie2006` is known for fewer ages than pupil and scatter.
fn age(o: &ObserverKeys) -> Check {
    let (low, high) = lens::AGES;
    if o.fundamentals == Set::Cie2006 && !(low..=high).contains(&o.age) {
        let why = "the ages whose lens CIE 170-1 gives; fundamentals = \"smj1993\" knows no age";
        return wrong("observer.age", short(o.age), &format!("{low} to {high}, {why}"));
    }
    within("observer.age", o.age, 5.0, 120.0)
}

fn probes(s: &Settings) -> Check {
    let mut names = HashSet::new();
    for probe in &s.output.probe {
        point("output.probe.at", probe.at)?;
        let unprintable = probe.name.is_empty()
            || probe.name.contains(|c: char| c.is_control() || c == ',' || c == '"');
        if unprintable || !names.insert(&probe.name) {
            return wrong(
                "output.probe.name",
                &probe.name,
                "a name of its own, without commas, quotes and control characters",
            );
        }
    }
    Ok(())
}

fn wrong(key: &str, found: impl std::fmt::Display, accepted: &str) -> Check {
    Err((key.into(), format!("found {found}; accepted: {accepted}")))
}

fn within(key: &str, value: f64, low: f64, high: f64) -> Check {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let low = if low == f64::MIN_POSITIVE { "more than 0".into() } else { short(low) };
    wrong(key, short(value), &format!("{low} to {}", short(high)))
}

/// A number as a person would write it.
fn short(value: f64) -> String {
    let plain = value == 0.0 || (1e-3..1e6).contains(&value.abs()) || !value.is_finite();
    if plain { format!("{value}") } else { format!("{value:e}") }
}

fn optional(key: &str, value: Option<f64>, low: f64, high: f64) -> Check {
    value.map_or(Ok(()), |v| within(key, v, low, high))
}

fn triple(key: &str, values: [f64; 3], low: f64, high: f64) -> Check {
    values.into_iter().try_for_each(|v| within(key, v, low, high))
}

fn point(key: &str, at: [f64; 2]) -> Check {
    if at.iter().all(|v| (0.0..=1.0).contains(v)) {
        return Ok(());
    }
    wrong(key, format!("{at:?}"), "fractions of width and height, 0 to 1")
}
