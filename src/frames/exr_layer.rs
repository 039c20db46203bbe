//! Which part and layer of an OpenEXR file is its picture.

use exr::meta::attribute::AttributeValue;
use exr::meta::header::Header;

use crate::colour::Primaries;
use crate::frames::channels::{Choice, Offer, choose, listed};
use crate::frames::exr_description::text;
use crate::frames::exr_file::ExrFile;
use crate::frames::options::ReadOptions;

/// What Blender calls the layer that is the whole picture, after the name of its view layer.
const WHOLE: &str = ".Combined";

/// The part, the prefix of the channels and the channels of the wanted layer; of a file of Blender's
/// without a picture outside its layers, the whole picture. The problem, if there is one, is a
/// message.
pub(super) fn chosen(
    file: &ExrFile,
    options: &ReadOptions,
) -> Result<(usize, String, Choice), String> {
    let found = in_layer(file, options, &options.layer);
    let names = layer_names(file);
    let mut whole = names.iter().filter(|name| name.ends_with(WHOLE));
    match (found, whole.next(), whole.next()) {
        (Err(_), Some(only), None) if options.layer.is_empty() => {
            let (part, prefix, mut choice) = in_layer(file, options, only)?;
            choice.notes.push(format!("layer `{only}`"));
            Ok((part, prefix, choice))
        }
        (found, ..) => found,
    }
}

fn in_layer(
    file: &ExrFile,
    options: &ReadOptions,
    layer: &str,
) -> Result<(usize, String, Choice), String> {
    let headers = file.meta.headers.iter().enumerate();
    let mut problem = None;
    for (index, header) in headers {
        if header.deep {
            problem = problem.or(Some("holds deep data; flat parts are read".into()));
            continue;
        }
        let named =
            header.own_attributes.layer_name.as_ref().is_some_and(|name| text(name) == layer);
        let prefixes = [
            (named || layer.is_empty()).then(String::new),
            (!layer.is_empty()).then(|| format!("{layer}.")),
        ];
        for prefix in prefixes.into_iter().flatten() {
            match choice_under(header, &prefix, options) {
                Some(Ok(choice)) => return Ok((index, prefix, choice)),
                Some(Err(message)) => problem = problem.or(Some(message)),
                None => {}
            }
        }
    }
    Err(problem.unwrap_or_else(|| format!("has no layer `{layer}`; it has {}", layers(file))))
}

/// The picture among the channels whose names begin with `prefix`; `None` where there are no such
/// channels.
fn choice_under(
    header: &Header,
    prefix: &str,
    options: &ReadOptions,
) -> Option<Result<Choice, String>> {
    let all: Vec<String> = header.channels.list.iter().map(|channel| text(&channel.name)).collect();
    let inside = |(i, name): (usize, &String)| Some((i, name.strip_prefix(prefix)?.to_owned()));
    let (indices, names): (Vec<usize>, Vec<String>) =
        all.iter().enumerate().filter_map(inside).unzip();
    let told = |name: &str| {
        let wanted = format!("{prefix}{name}.wavelength");
        let attributes = &header.own_attributes.other;
        match attributes.get(wanted.as_bytes())? {
            AttributeValue::F32(metres) => Some(f64::from(*metres)),
            AttributeValue::F64(metres) => Some(*metres),
            _ => None,
        }
    };
    let primaries = header.shared_attributes.chromaticities.map(|c| {
        let point = |v: exr::math::Vec2<f32>| [decimal(v.0), decimal(v.1)];
        Primaries {
            red: point(c.red),
            green: point(c.green),
            blue: point(c.blue),
            white: point(c.white),
        }
    });
    (!names.is_empty()).then(|| {
        let mut choice = choose(&Offer { names: &names, told: &told, primaries }, options)?;
        choice.channels.iter_mut().for_each(|channel| *channel = indices[*channel]);
        Ok(choice)
    })
}

/// The shortest decimal number that a float stands for: 0.64, not 0.639999986.
fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// Names of parts, and of layers inside them.
fn layer_names(file: &ExrFile) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for header in &file.meta.headers {
        names.extend(header.own_attributes.layer_name.as_ref().map(text));
        let channels = header.channels.list.iter().map(|channel| text(&channel.name));
        names.extend(
            channels.filter_map(|name| name.rsplit_once('.').map(|(layer, _)| layer.to_owned())),
        );
    }
    names.sort();
    names.dedup();
    names
}

/// The same, for people.
fn layers(file: &ExrFile) -> String {
    let names = layer_names(file);
    if names.is_empty() {
        "none, so leave `layer` empty".into()
    } else {
        listed(&names).replacen("channel", "layer", 1)
    }
}
