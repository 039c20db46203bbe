//! Family: a figure of many cases in time, six panels for each place: bleached L, M and S, then
//! luminance and chromaticity of the percept. A curve is a case; panels share their axes, and
//! colours go with a value from dark to bright.

use super::axes::{Axis, Panel};
use super::font;
use super::moment::{Cones, Moment, course, luminance_axis, note_breaks};
use super::palette::{BLACK, GREY, ordered};
use super::sheet::{Anchor, Ink, Sheet};

const WIDTH: f64 = 1000.0;
/// From one probe's panels to the next.
const PITCH: f64 = 566.0;
/// Left edges of the panels, and their size.
const LEFTS: [f64; 3] = [72.0, 352.0, 632.0];
const SIZE: [f64; 2] = [224.0, 190.0];
/// From the upper row of panels to the lower.
const LOWER: f64 = 240.0;
/// More curves than these cannot be named one by one.
pub(crate) const MOST_NAMED: usize = 12;
/// Dashes by which curves of one colour differ.
const DASHES: [&str; 4] = ["", "9 4", "2 3", "9 3 2 3"];

/// A case of the family: its name, where it stands among the others, and the rows of one probe.
pub(crate) struct Member {
    pub(crate) name: String,
    pub(crate) ink: Ink,
    /// Which of [`DASHES`].
    pub(crate) dash: usize,
    pub(crate) rows: Vec<Moment>,
    pub(crate) cones: Cones,
    /// Bleached L, M, S, then x, y under the last light for ever.
    pub(crate) steady: Option<[f64; 5]>,
}

/// What colours and dashes stand for.
pub(crate) struct Scale {
    /// What varies.
    pub(crate) name: String,
    /// Values at places from 0 to 1.
    pub(crate) labels: Vec<(f64, String)>,
    /// What each of [`DASHES`] stands for, if they differ.
    pub(crate) dashes: Vec<String>,
}

/// One probe in all cases.
pub(crate) struct Family {
    pub(crate) name: String,
    pub(crate) members: Vec<Member>,
}

/// What a panel shows of a moment.
type Quantity = fn(&Moment) -> f64;

/// Quantities in the order of the panels, with their titles.
const QUANTITIES: [(&str, Quantity); 6] = [
    ("L", |at| at.bleached(0)),
    ("M", |at| at.bleached(1)),
    ("S", |at| at.bleached(2)),
    ("Y", |at| at.xyz[1]),
    ("x", |at| at.chromaticity(0)),
    ("y", |at| at.chromaticity(1)),
];

/// The figure of families of curves, one block of panels each.
pub(crate) fn drawn(families: &[Family], scale: &Scale) -> Sheet {
    let mut sheet = Sheet::new(WIDTH, PITCH * families.len().max(1) as f64 + 8.0);
    let x = time_axis(families.iter().flat_map(|family| &family.members));
    for (i, family) in families.iter().enumerate() {
        block(&mut sheet, family, scale, x, PITCH * i as f64 + 70.0);
    }
    sheet
}

/// The six panels of one probe, under its name.
fn block(sheet: &mut Sheet, family: &Family, scale: &Scale, x: Axis, top: f64) {
    sheet.bold((LEFTS[0], top - 44.0), &family.name, 18, Anchor::Start, BLACK);
    let of_member = |member: &Member| course(&member.rows, &member.cones, &x);
    let courses: Vec<Vec<Moment>> = family.members.iter().map(of_member).collect();
    let y = axes(&courses);
    for (i, (title, value)) in QUANTITIES.into_iter().enumerate() {
        let (row, column) = (i / 3, i % 3);
        let top = top + LOWER * row as f64;
        let panel = Panel { left: LEFTS[column], top, width: SIZE[0], height: SIZE[1], x, y: y[i] };
        panel.framed(sheet, [row == 1, i % 3 == 0 || i == 4]);
        sheet.bold((panel.left, top - 8.0), title, 16, Anchor::Start, BLACK);
        for (member, course) in family.members.iter().zip(&courses) {
            curve(sheet, &panel, member, course, value, family.members.len());
        }
        if family.members.len() <= MOST_NAMED {
            steady_ticks(sheet, &panel, family, i);
        }
        let known = courses.iter().flatten().filter(|at| at.xyz[1].is_finite());
        note_breaks(sheet, &panel, known.map(value));
        if column == 2 && family.members.len() <= MOST_NAMED {
            name_curves(sheet, &panel, family, &courses, value);
        }
    }
    legend(sheet, family, scale, top);
}

fn axes(courses: &[Vec<Moment>]) -> [Axis<'static>; 6] {
    let bleached = Axis::linear(0.0, 1.0, 5.0, "bleached fraction");
    let luminance = luminance_axis(courses.iter().flatten().map(|at| at.xyz[1]));
    let colour = Axis::linear(0.0, 0.8, 5.0, "");
    let bare = Axis { label: "", ..bleached };
    [bleached, bare, bare, luminance, colour, colour]
}

/// One case in one panel, with a dot at each duration where they can be told apart.
fn curve(
    sheet: &mut Sheet,
    panel: &Panel,
    member: &Member,
    course: &[Moment],
    value: Quantity,
    members: usize,
) {
    let (ink, dash) = (member.ink, DASHES[member.dash % DASHES.len()]);
    let width = if members > 40 { 0.8 } else { 1.7 };
    let pair = |at: &Moment| (at.time, value(at));
    panel.curve(sheet, &course.iter().map(pair).collect::<Vec<_>>(), ink, width, dash);
    if members * member.rows.len() <= 200 {
        for row in &member.rows {
            panel.curve(sheet, &[pair(row)], ink, width, "");
        }
    }
}

/// Short strokes beyond the panel where a case would come to rest.
fn steady_ticks(sheet: &mut Sheet, panel: &Panel, family: &Family, quantity: usize) {
    let Some(column) = [Some(0), Some(1), Some(2), None, Some(3), Some(4)][quantity] else {
        return;
    };
    for member in &family.members {
        let rest = member.steady.map_or(f64::NAN, |steady| steady[column]);
        if panel.y.holds(rest) {
            let (x, y) = panel.at(panel.x.to, rest);
            sheet.line((x + 1.0, y), (x + 9.0, y), member.ink, 2.6, "");
        }
    }
}

/// Names beside the ends of curves, as much of them as there is room for.
fn name_curves(
    sheet: &mut Sheet,
    panel: &Panel,
    family: &Family,
    courses: &[Vec<Moment>],
    value: Quantity,
) {
    let ends = family.members.iter().zip(courses).map(|(member, course)| {
        let last = course.iter().map(value).rfind(|value| panel.y.holds(*value));
        (
            last.unwrap_or(panel.y.from),
            fitted(&member.name, WIDTH - panel.right() - 22.0),
            member.ink,
        )
    });
    let ends: Vec<(f64, String, Ink)> = ends.collect();
    let names: Vec<(f64, &str, Ink)> =
        ends.iter().map(|(y, name, ink)| (*y, name.as_str(), *ink)).collect();
    panel.name_ends(sheet, &names, NAME_TYPE);
}

const NAME_TYPE: u32 = 13;

/// Names as far as there is room.
fn fitted(words: &str, room: f64) -> String {
    font::fitted(words, f64::from(NAME_TYPE), room)
}

/// What colours mean: the key's name beside the probe's, and a bar with values where curves are too
/// many to be named.
fn legend(sheet: &mut Sheet, family: &Family, scale: &Scale, top: f64) {
    let right = LEFTS[2] + SIZE[0];
    let named = family.members.len() <= MOST_NAMED;
    if named {
        let words = "strokes at the right edge: where it would come to rest";
        sheet.text((right, top - 44.0), words, 13, Anchor::End, GREY);
        sheet.text(
            (right + 12.0, top - 8.0),
            &fitted(&scale.name, WIDTH - right - 14.0),
            NAME_TYPE,
            Anchor::Start,
            BLACK,
        );
        return;
    }
    let (left, height) = (right + 22.0, LOWER + SIZE[1]);
    sheet.text(
        (left, top - 14.0),
        &fitted(&scale.name, WIDTH - left - 6.0),
        NAME_TYPE,
        Anchor::Start,
        BLACK,
    );
    dashes_named(sheet, scale, top - 44.0);
    const STEPS: usize = 100;
    for i in 0..STEPS {
        let share = i as f64 / STEPS as f64;
        let ink = ordered(1.0 - share);
        sheet.block((left, top + height * share), 14.0, height / STEPS as f64 + 0.5, ink);
    }
    for (place, label) in &scale.labels {
        let y = top + height * (1.0 - place);
        sheet.line((left + 14.0, y), (left + 19.0, y), BLACK, 1.0, "");
        sheet.text((left + 23.0, y + 5.0), label, 14, Anchor::Start, BLACK);
    }
}

/// Samples of the dashes, from the right, where there are few.
fn dashes_named(sheet: &mut Sheet, scale: &Scale, y: f64) {
    if !(2..=DASHES.len()).contains(&scale.dashes.len()) {
        return;
    }
    let mut x = LEFTS[2] + SIZE[0];
    for (name, dash) in scale.dashes.iter().zip(DASHES).rev() {
        sheet.text((x, y), name, NAME_TYPE, Anchor::End, BLACK);
        x -= font::width(name, f64::from(NAME_TYPE), false) + 8.0;
        sheet.line((x - 34.0, y - 4.5), (x, y - 4.5), BLACK, 1.7, dash);
        x -= 54.0;
    }
}

/// Powers of ten where durations span more than a factor of twenty, from before the first of them.
fn time_axis<'a>(members: impl Iterator<Item = &'a Member>) -> Axis<'static> {
    let times = members.flat_map(|member| member.rows.iter().map(|row| row.time));
    let (first, last) = times
        .filter(|time| *time > 0.0)
        .fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), t| (a.min(t), b.max(t)));
    if last <= 20.0 * first {
        return Axis::linear(0.0, last, 4.0, "duration (s)");
    }
    let from = 10f64.powf((first.log10() - 1e-9).ceil() - 1.0);
    Axis::logarithmic(from, last, 4.0, "duration (s)")
}
