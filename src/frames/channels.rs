//! Which channels of a file are its picture: the three of RGB, or bands in order of wavelength.

use crate::colour::Primaries;
use crate::frames::names::{Meaning, meaning, number_in};
use crate::frames::options::{ChannelNames, Quantity, ReadOptions, Wanted};
use crate::frames::picture::Kind;
use crate::frames::visible;
use crate::spectrum::{Band, Bands};

/// What is known of the channels of one part of a file.
pub(super) struct Offer<'a> {
    /// Channel names without the layer, in the file's order.
    pub(crate) names: &'a [String],
    /// Wavelength of a channel, m, where an attribute tells it (`wl0.wavelength`, as Ocean writes).
    pub(crate) told: &'a dyn Fn(&str) -> Option<f64>,
    /// Primaries, where the file tells.
    pub(crate) primaries: Option<Primaries>,
}

/// The picture in a file: what its planes are and where they come from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Choice {
    pub(crate) kind: Kind,
    /// For each plane the index of its channel. Bands rise in wavelength.
    pub(crate) channels: Vec<usize>,
    /// For each band, the factor to W m^-2 sr^-1 nm^-1; empty for RGB.
    pub(crate) scale: Vec<f64>,
    /// Whether the three channels are luminance Y and the differences RY and BY.
    pub(crate) chroma: bool,
    pub(crate) notes: Vec<String>,
}

/// Chooses the picture. The problem, if there is one, is a message.
pub(super) fn choose(offer: &Offer, options: &ReadOptions) -> Result<Choice, String> {
    if options.wanted != Wanted::Rgb {
        let mut found = bands_of(offer, &options.channels)?;
        if !found.is_empty() {
            found.sort_by(|a, b| a.1.centre.total_cmp(&b.1.centre));
            return spectral(offer, options, &found);
        }
    }
    match colours(offer.names) {
        Some(colours) if options.wanted != Wanted::Spectral => Ok(rgb(offer, options, colours)),
        _ => Err(nothing_found(offer.names, options.wanted)),
    }
}

fn rgb(offer: &Offer, options: &ReadOptions, colours: Colours) -> Choice {
    let mut notes = passed_over(offer.names, &colours.channels);
    notes.extend(colours.note);
    let told = colours.primaries.or(options.primaries).or(offer.primaries);
    let primaries = told.unwrap_or(Primaries::REC709);
    Choice {
        kind: Kind::Rgb(primaries),
        channels: colours.channels.to_vec(),
        scale: Vec::new(),
        chroma: colours.chroma,
        notes,
    }
}

fn spectral(
    offer: &Offer,
    options: &ReadOptions,
    found: &[(usize, Band)],
) -> Result<Choice, String> {
    if let Some(pair) = found.windows(2).find(|pair| pair[0].1.centre == pair[1].1.centre) {
        let (a, b) = (&offer.names[pair[0].0], &offer.names[pair[1].0]);
        return Err(format!("channels `{a}` and `{b}` both stand for {} nm", pair[0].1.centre));
    }
    let stated = found.iter().all(|(_, band)| band.high > band.low);
    let bands = if stated {
        Bands::new(found.iter().map(|found| found.1).collect())
    } else {
        Bands::from_centres(&found.iter().map(|found| found.1.centre).collect::<Vec<_>>())
    };
    let bands = bands
        .ok_or("the wavelengths of its bands must be positive, with limits around each centre")?;
    let channels: Vec<usize> = found.iter().map(|found| found.0).collect();
    let scale = bands.as_slice().iter().map(|band| match options.quantity {
        Quantity::Density => options.scale,
        Quantity::BandIntegral => options.scale / band.width(),
    });
    let scale = scale.collect();
    let mut notes = passed_over(offer.names, &channels);
    notes.extend(visible::examine(&bands)?);
    Ok(Choice { kind: Kind::Spectral(bands), channels, scale, chroma: false, notes })
}

/// A band known by its centre only: its limits follow from its neighbours.
fn centred(nm: f64) -> Band {
    Band { centre: nm, low: nm, high: nm }
}

/// The bands among the channels, unsorted; empty where there are none.
fn bands_of(offer: &Offer, how: &ChannelNames) -> Result<Vec<(usize, Band)>, String> {
    match how {
        ChannelNames::Recognised => recognised(offer),
        ChannelNames::Wavelength(pattern) => {
            let found = matched(offer.names, pattern, "{nm}")?;
            Ok(found.into_iter().map(|(channel, nm)| (channel, centred(nm))).collect())
        }
        ChannelNames::Index { pattern, from, to } => {
            let mut found = matched(offer.names, pattern, "{index}")?;
            found.sort_by(|a, b| a.1.total_cmp(&b.1));
            let gapless = found.windows(2).all(|pair| pair[1].1 - pair[0].1 == 1.0);
            let bands = Bands::uniform(*from, *to, found.len()).filter(|_| gapless).ok_or_else(|| {
                format!("the numbers under `{pattern}` have a gap, or {from} to {to} nm is not a range of wavelengths")
            })?;
            Ok(found
                .into_iter()
                .map(|found| found.0)
                .zip(bands.as_slice().iter().copied())
                .collect())
        }
        ChannelNames::Listed(list) => {
            let band = |(name, centre, width): &(String, f64, f64)| {
                let at = offer.names.iter().position(|n| n == name);
                let at = at.ok_or_else(|| {
                    format!("no channel `{name}`; it has {}", listed(offer.names))
                })?;
                Ok((
                    at,
                    Band { centre: *centre, low: centre - width / 2.0, high: centre + width / 2.0 },
                ))
            };
            list.iter().map(band).collect()
        }
    }
}

fn recognised(offer: &Offer) -> Result<Vec<(usize, Band)>, String> {
    let meanings: Vec<Meaning> = offer.names.iter().map(|name| meaning(name)).collect();
    let bands_where = |pick: &dyn Fn(usize, &Meaning) -> Option<Band>| -> Vec<(usize, Band)> {
        meanings.iter().enumerate().filter_map(|(i, m)| Some((i, pick(i, m)?))).collect()
    };
    let radiance =
        bands_where(&|_, m| if let Meaning::Radiance(nm) = m { Some(centred(*nm)) } else { None });
    if !radiance.is_empty() {
        return Ok(radiance);
    }
    let between =
        bands_where(&|_, m| if let Meaning::Between(band) = m { Some(*band) } else { None });
    if !between.is_empty() {
        return Ok(between);
    }
    let told = bands_where(&|i, _| {
        (offer.told)(&offer.names[i]).map(|metres| centred((metres * 1e15).round() / 1e6))
    });
    if told.is_empty() && meanings.contains(&Meaning::Reflective) && colours(offer.names).is_none()
    {
        return Err(
            "holds reflectances (channels `T.*`), not light; render the scene to radiance (channels `S0.*`)".into()
        );
    }
    Ok(told)
}

/// The channels that match a pattern, each with its number.
fn matched(names: &[String], pattern: &str, mark: &str) -> Result<Vec<(usize, f64)>, String> {
    let (before, after) = pattern
        .split_once(mark)
        .ok_or_else(|| format!("the pattern `{pattern}` has no `{mark}` in it"))?;
    let found: Vec<_> = names
        .iter()
        .enumerate()
        .filter_map(|(i, name)| Some((i, number_in(name, before, after)?)))
        .collect();
    if found.is_empty() {
        return Err(format!("no channel matches `{pattern}`; it has {}", listed(names)));
    }
    Ok(found)
}

/// The channels of a picture in three colours, and what they mean.
struct Colours {
    channels: [usize; 3],
    /// Primaries that the channels' names tell, whatever the file says.
    primaries: Option<Primaries>,
    /// Luminance Y and the differences RY and BY, from which red, green and blue follow.
    chroma: bool,
    note: Option<String>,
}

impl Colours {
    fn plain(channels: [usize; 3]) -> Colours {
        Colours { channels, primaries: None, chroma: false, note: None }
    }
}

/// Spellings of red, green and blue. Case matters only to prefer `R` to `r`.
const SPELLINGS: [[&str; 3]; 2] = [["R", "G", "B"], ["red", "green", "blue"]];
/// Names of a channel that is a picture by itself, in grey.
const GREYS: [&str; 4] = ["Y", "L", "luminance", "grey"];

fn colours(names: &[String]) -> Option<Colours> {
    let exact = |wanted: &str| names.iter().position(|name| name == wanted);
    let loose = |wanted: &str| {
        exact(wanted).or_else(|| names.iter().position(|name| name.eq_ignore_ascii_case(wanted)))
    };
    let three = |wanted: [&str; 3]| match wanted.map(loose) {
        [Some(a), Some(b), Some(c)] => Some([a, b, c]),
        _ => None,
    };
    if let Some(channels) = SPELLINGS.into_iter().find_map(three) {
        return Some(Colours::plain(channels));
    }
    if let [Some(x), Some(y), Some(z)] = ["X", "Y", "Z"].map(exact) {
        let note = Some("channels X, Y, Z: read as CIE XYZ".into());
        let primaries = Some(Primaries::XYZ);
        return Some(Colours { primaries, note, ..Colours::plain([x, y, z]) });
    }
    if let [Some(y), Some(ry), Some(by)] = ["Y", "RY", "BY"].map(exact) {
        return Some(Colours { chroma: true, ..Colours::plain([y, ry, by]) });
    }
    let alone = || match SPELLINGS[0].map(loose) {
        [Some(one), None, None] | [None, Some(one), None] | [None, None, Some(one)] => Some(one),
        _ => None,
    };
    let grey = GREYS.into_iter().find_map(loose).or_else(alone)?;
    let note = Some(format!("only a channel `{}`: read as grey", names[grey].escape_debug()));
    Some(Colours { note, ..Colours::plain([grey; 3]) })
}

fn passed_over(names: &[String], used: &[usize]) -> Vec<String> {
    let others: Vec<String> = names
        .iter()
        .enumerate()
        .filter(|(i, _)| !used.contains(i))
        .map(|(_, name)| name.clone())
        .collect();
    let (stokes, others): (Vec<_>, Vec<_>) =
        others.into_iter().partition(|n| meaning(n) == Meaning::Polarisation);
    let mut notes = Vec::new();
    if !stokes.is_empty() {
        notes.push(format!(
            "not looked at: the polarisation (S1, S2, S3) in {} channels",
            stokes.len()
        ));
    }
    if !others.is_empty() {
        notes.push(format!("not looked at: {}", listed(&others)));
    }
    notes
}

/// Names in a sentence, at most a dozen of them.
pub(super) fn listed(names: &[String]) -> String {
    let shown: Vec<String> =
        names.iter().take(12).map(|name| format!("`{}`", name.escape_debug())).collect();
    let more =
        if names.len() > 12 { format!(" and {} more", names.len() - 12) } else { String::new() };
    match names.len() {
        0 => "no channels".into(),
        1 => format!("channel {}", shown[0]),
        _ => format!("channels {}{more}", shown.join(", ")),
    }
}

fn nothing_found(names: &[String], wanted: Wanted) -> String {
    let has = listed(names);
    match wanted {
        Wanted::Rgb => format!(
            "has no picture in channels R, G, B (also r, g, b or red, green, blue), X, Y, Z, or Y, \
             RY, BY, and none in one channel Y, L, R, G or B, read as grey; it has {has}"
        ),
        _ => format!(
            "has neither bands with names that tell their wavelengths nor R, G, B nor X, Y, Z nor \
             one channel that could be read as grey; it has {has}. Say which channel is which \
             wavelength, for instance channels = \"S0_{{nm}}nm\", or channels = \
             \"band_{{index}}\" with bands_nm = {{ from = 395, to = 705 }}, or a list of {{ name, \
             centre_nm, width_nm }}; another layer or part is chosen by `layer`"
        ),
    }
}
