//! An inspection as lines to read.

use std::fmt::{Display, Formatter, Result};

use crate::frames::inspect::Inspection;

impl Display for Inspection {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (file, format) = (&self.file, &self.format);
        let kind = self.kind.unwrap_or("unrecognised");
        writeln!(f, "{file}: {kind} {format}, {} x {} pixels", self.width, self.height)?;
        self.colours(f)?;
        self.storage(f)?;
        self.time(f)?;
        if let Some([low, high]) = self.luminance_cd_m2 {
            line(f, "luminance", format!("{} to {} cd/m2", short(low), short(high)))?;
        }
        self.values(f)?;
        for (name, text) in self.exr.iter().flat_map(|exr| &exr.attributes) {
            line(f, "attribute", format!("{name} = {text}"))?;
        }
        self.notes.iter().try_for_each(|note| line(f, "note", note))
    }
}

impl Inspection {
    fn colours(&self, f: &mut Formatter<'_>) -> Result {
        if let Some(primaries) = &self.primaries {
            let points = primaries.map(|[x, y]| format!("{x} {y}"));
            line(f, "primaries", format!("{}; white {}", points[..3].join(", "), points[3]))?;
        }
        if let Some(bands) = &self.bands_nm {
            line(f, "bands", bands_text(bands))?;
        }
        Ok(())
    }

    fn storage(&self, f: &mut Formatter<'_>) -> Result {
        if let Some(exr) = &self.exr {
            line(f, "channels", exr_channels(&exr.channels))?;
            line(f, "compression", &exr.compression)?;
            if exr.data_window != exr.display_window {
                let windows = format!("{:?} in {:?}", exr.data_window, exr.display_window);
                line(f, "data window", windows)?;
            }
        }
        if let Some(white) = self.white_cd_m2 {
            line(f, "white", format!("{white} cd/m2"))?;
        }
        Ok(())
    }

    fn time(&self, f: &mut Formatter<'_>) -> Result {
        if let (Some(frames), Some(duration)) = (self.frames, self.duration_s) {
            let film = format!("{frames} frames in {} s; values of the first", short(duration));
            line(f, "film", film)?;
        }
        if let Some(rate) = self.frames_per_second {
            line(f, "frame rate", format!("{rate} /s"))?;
        }
        Ok(())
    }

    fn values(&self, f: &mut Formatter<'_>) -> Result {
        if self.ranges.is_empty() {
            return Ok(());
        }
        let low = self.ranges.iter().fold(f64::INFINITY, |low, range| low.min(range[0]));
        let high = self.ranges.iter().fold(f64::NEG_INFINITY, |high, range| high.max(range[1]));
        line(f, "values", format!("{} to {}", short(low), short(high)))?;
        let counts = [
            (self.nan, "NaN"),
            (self.infinite, "infinite"),
            (self.negative, "negative"),
            (self.clipped, "at the top of their range"),
        ];
        let found: Vec<String> = counts
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{count} {what}"))
            .collect();
        line(
            f,
            "samples",
            if found.is_empty() { "all finite, none negative".into() } else { found.join(", ") },
        )
    }
}

fn line(f: &mut Formatter<'_>, key: &str, text: impl Display) -> Result {
    writeln!(f, "  {key:<12}{text}")
}

/// Four significant digits, plain where that is short.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => {
            let digits = (3 - size.log10().floor() as i32).max(0) as usize;
            let text = format!("{value:.digits$}");
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').into()
            } else {
                text
            }
        }
        _ => format!("{value:.3e}"),
    }
}

fn bands_text(bands: &[[f64; 3]]) -> String {
    let (first, last) = (bands[0], bands[bands.len() - 1]);
    let widths = bands.iter().map(|band| band[2] - band[1]);
    let (least, most) = (widths.clone().fold(f64::INFINITY, f64::min), widths.fold(0.0, f64::max));
    let wide = if most - least < 1e-6 * most {
        short(most)
    } else {
        format!("{} to {}", short(least), short(most))
    };
    format!("{}, {} to {} nm, each {wide} nm wide", bands.len(), short(first[0]), short(last[0]))
}

fn exr_channels(channels: &[crate::frames::Channel]) -> String {
    let shown: Vec<String> = channels
        .iter()
        .take(6)
        .map(|channel| format!("{} {}", channel.name, channel.stored))
        .collect();
    let more = if channels.len() > 6 {
        format!(", and {} more", channels.len() - 6)
    } else {
        String::new()
    };
    shown.join(", ") + &more
}
