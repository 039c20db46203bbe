//! Settings -> the things they name.

use crate::display::{Display, Tone};
use crate::error::{Error, Result};
use crate::eye::pigment::Model;
use crate::eye::plan;
use crate::frames::builtin::Sunset;
use crate::frames::{ChannelNames, Compression, ReadOptions, Sequence, Transfer};
use crate::kinetics::Kinetics;
use crate::observer::{Directional, Dynamics, Field, Observer, Reading, Rule, Set};
use crate::optics::Scatter;
use crate::step::Method;
use crate::units::{Degrees, Millimetres, Nits, Seconds, Trolands};

use super::settings::*;
use super::{Config, field};

impl Config {
    /// The observer of `[observer]`.
    pub fn observer(&self) -> Observer {
        let o = &self.settings.observer;
        let field = if o.field_deg == 2 { Field::TwoDegrees } else { Field::TenDegrees };
        let (set, directional) = (o.fundamentals, self.directional());
        let mut observer = Observer::new(set, field, self.density(), o.narrowing, directional);
        if set == Set::Cie2006 && !self.is_at_the_retina() {
            observer = observer.aged(o.age);
        }
        observer.pupil = self.pupil();
        observer.dynamics = Dynamics {
            delay: Seconds(o.pupil_delay_s),
            closing: Seconds(o.pupil_closing_s),
            opening: Seconds(o.pupil_opening_s),
        };
        observer.fovea = Degrees(self.settings.gaze.fovea_deg);
        observer
    }

    fn density(&self) -> [f64; 3] {
        self.settings.observer.optical_density.unwrap_or([0.50, 0.50, 0.40])
    }

    fn directional(&self) -> Directional {
        let o = &self.settings.observer;
        let reading = match o.stiles_crawford {
            _ if self.is_at_the_retina() => Reading::Off,
            Reading::Paper { .. } => Reading::Paper { mm_per_degree: o.mm_per_degree },
            reading => reading,
        };
        Directional::new(reading, o.stiles_crawford_p)
    }

    fn pupil(&self) -> Rule {
        let o = &self.settings.observer;
        match o.pupil {
            _ if self.is_at_the_retina() => Rule::Fixed(field::UNIT_PUPIL),
            Rule::WatsonYellott { .. } => Rule::WatsonYellott { age: o.age, eyes: o.eyes },
            Rule::Fixed(_) => Rule::Fixed(Millimetres(o.pupil_mm.unwrap_or_default())),
            formula => formula,
        }
    }

    /// The kinetics of the L, M and S cones.
    pub fn pigments(&self) -> [Kinetics; 3] {
        let o = &self.settings.observer;
        [0, 1, 2].map(|k| Kinetics {
            law: o.kinetics.with(self.density()[k], o.km),
            half_bleach: Trolands(10f64.powf(o.half_bleach_log_td[k])),
            tau: Seconds(o.tau_s[k]),
        })
    }

    /// The row of the method table that `numerics.method` names.
    fn method(&self) -> Result<&'static Method> {
        let name = &self.settings.numerics.method;
        Method::named(name).ok_or_else(|| {
            let names: Vec<_> = crate::step::METHODS.iter().map(|m| m.name).collect();
            self.wrong("numerics.method", format!("found {name:?}; accepted: {}", names.join(", ")))
        })
    }

    /// The scatter of the observer's eye.
    pub fn scatter(&self) -> Scatter {
        let (optics, observer) = (&self.settings.optics, &self.settings.observer);
        Scatter {
            psf: optics.psf.unwrap_or_default(),
            age: observer.age,
            pigmentation: observer.pigmentation,
            straylight: optics.straylight,
            core_deg: optics.core_deg,
        }
    }

    /// The display of `[display]`.
    pub fn display(&self) -> Display {
        let d = &self.settings.display;
        Display {
            white: Nits(d.white_cd_m2),
            tone: match d.tone {
                Tone::Ward(_) => Tone::Ward(d.ceiling),
                Tone::Exposure { .. } => Tone::Exposure { ev: d.exposure_ev },
            },
            smoothing: Seconds(d.smoothing_s),
            highlights: d.highlights,
        }
    }

    /// How the files of `[input]` are to be read.
    pub fn read_options(&self) -> Result<ReadOptions> {
        let input = &self.settings.input;
        Ok(ReadOptions {
            wanted: input.kind,
            layer: input.layer.clone(),
            scale: input.scale,
            quantity: input.quantity,
            channels: self.channel_names()?,
            overscan: self.settings.output.keep,
            non_finite: input.non_finite,
            negative: input.negative,
            max_pixels: input.max_pixels,
            own_white: input.white_cd_m2.is_none(),
            primaries: input.primaries,
            transfer: input.transfer.map(|curve| match curve {
                Transfer::Hlg(_) => Transfer::Hlg(input.peak_cd_m2),
                curve => curve,
            }),
            peak_cd_m2: input.peak_cd_m2,
            matrix: input.matrix,
            full_range: input.code_range,
        })
    }

    fn channel_names(&self) -> Result<ChannelNames> {
        let input = &self.settings.input;
        match (&input.channels, input.bands_nm) {
            (None, None) => Ok(ChannelNames::Recognised),
            (Some(Channels::Pattern(pattern)), Some(BandRange { from, to })) if pattern.contains("{index}") => {
                if !(from > 0.0 && from < to && to < 1e5) {
                    return Err(self
                        .wrong("input.bands_nm", format!("found {from} to {to}; accepted: rising wavelengths in nm")));
                }
                Ok(ChannelNames::Index { pattern: pattern.clone(), from, to })
            }
            (Some(Channels::Pattern(pattern)), None) if pattern.contains("{nm}") => {
                Ok(ChannelNames::Wavelength(pattern.clone()))
            }
            (Some(Channels::Pattern(pattern)), _) => Err(self.wrong(
                "input.channels",
                format!(
                    "found {pattern:?}; accepted: a pattern with {{nm}}, or one with {{index}} beside input.bands_nm"
                ),
            )),
            (Some(Channels::Listed(list)), None) => {
                let row = |c: &Channel| (c.name.clone(), c.centre_nm, c.width_nm);
                Ok(ChannelNames::Listed(list.iter().map(row).collect()))
            }
            (_, Some(_)) => Err(self.wrong("input.bands_nm", "belongs to input.channels with {index}")),
        }
    }

    /// Compression of the percept's files. `auto` is ZIP, which every program reads, and of the
    /// codes that lose nothing the one to prefer by measurement: nearly the smallest, and written
    /// almost as fast as bare samples. A 1080p half RGB frame with two per cent of noise, on one
    /// core (`cargo bench --bench against_copy -- 2 EXR`):
    ///
    /// | code | none | rle | zips | zip | piz |
    /// |---|---|---|---|---|---|
    /// | share of the bytes | 100 % | 55 % | 38 % | 38 % | 35 % |
    /// | written in | 17 ms | 35 ms | 36 ms | 22 ms | 85 ms |
    /// | read in | 7 ms | 14 ms | 38 ms | 29 ms | 80 ms |
    pub fn compression(&self) -> Result<Compression> {
        match self.settings.output.compression.as_str() {
            "auto" => Ok(Compression::Zip),
            name => name.parse().map_err(|problem: String| {
                self.wrong("output.compression", format!("{problem}, auto"))
            }),
        }
    }

    /// The numbered frames and files of `input.frames`; `None` for the built-in scene.
    pub fn sequence(&self) -> Result<Option<Sequence>> {
        let input = &self.settings.input;
        let names = match &input.frames {
            None => return Ok(None),
            Some(OneOrMany::One(name)) => std::slice::from_ref(name),
            Some(OneOrMany::Many(names)) => names,
        };
        let found = Sequence::find(names, &self.base, &input.range, input.missing);
        found.map(Some).map_err(|error| match error {
            Error::Config { key, problem, .. } => self.wrong(&format!("input.{key}"), problem),
            Error::File { path, problem } => {
                self.wrong("input.frames", format!("{}: {problem}", path.display()))
            }
            other => other,
        })
    }

    /// The built-in scene of `[input]`.
    pub(crate) fn scene(&self) -> Sunset {
        let input = &self.settings.input;
        let (elevation, turbidity) =
            (input.sun_elevation_deg.unwrap_or(0.5), input.turbidity.unwrap_or(2.5));
        Sunset::new(input.width.unwrap_or(480) as usize, elevation, turbidity)
    }

    /// How pigment is to follow light.
    pub fn model(&self) -> Result<Model> {
        let n = &self.settings.numerics;
        Ok(match n.model {
            ModelKey::None => Model::Unbleached,
            ModelKey::Steady => Model::Steady,
            ModelKey::Auto | ModelKey::Tracked => Model::Tracked {
                method: self.method()?,
                substeps: n.substeps,
                budget: plan::SUBSTEPS * n.budget,
            },
        })
    }

    /// The budget within which less may be modelled (`numerics.model = "auto"`); `None`: what was
    /// asked for is done everywhere.
    pub(crate) fn budget(&self) -> Option<f64> {
        let n = &self.settings.numerics;
        (n.model == ModelKey::Auto).then_some(n.budget)
    }
}
