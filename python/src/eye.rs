//! An eye that looks at frames in memory.

use std::sync::{Mutex, MutexGuard};

use numpy::PyArray3;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sungaze::colour::Primaries;
use sungaze::config::settings::Aim;
use sungaze::config::{Config, Value};
use sungaze::display::{Screen, ToneMap};
use sungaze::error::Result as Looked;
use sungaze::eye::{self, Gaze, Light, State};
use sungaze::frames::View;
use sungaze::optics::Psf;
use sungaze::spectrum::Bands;
use sungaze::units::{Degrees, Nits, Seconds};

use crate::arrays::{Frame, FrameView, writable};
use crate::config::{config_of, described};
use crate::errors::{raised, refused};
use crate::look::Look;
use crate::pool::awake;

/// An observer's eye that watches frames of one size.
///
/// RGB frames hold linear RGB in sRGB's primaries and need `white_cd_m2`; spectral ones hold W m^-2
/// sr^-1 nm^-1 in bands and need `bands_nm`. Pixels are counted from the top left.
///
/// Parameters
/// ----------
/// config : str, os.PathLike, dict or None
///     The keys of a configuration: a TOML file, or a dict of its tables. `[observer]`,
///     `[numerics]`, `[gaze]` and `[display]` are used; `input.frames` is not opened.
/// width, height : int
///     Size of the frames, pixels.
/// horizontal_fov_deg : float
///     How many degrees they are across; the configuration's `input.horizontal_fov_deg` otherwise.
/// white_cd_m2 : float
///     RGB: luminance of (1, 1, 1), cd/m2; the configuration's `input.white_cd_m2` otherwise.
/// bands_nm : array_like
///     Spectral: the centres of the bands, nm, rising.
///
/// Raises
/// ------
/// ValueError
///     A key, a size or a scale is missing or not accepted.
///
/// Examples
/// --------
/// Ten seconds of a bright disc, and the after-image on grey:
///
/// >>> import numpy as np
/// >>> import sungaze
/// >>> eye = sungaze.Eye(width=64, height=48, horizontal_fov_deg=8, white_cd_m2=1e5)
/// >>> sun = np.full((48, 64, 3), 0.01, np.float32)
/// >>> sun[16:32, 24:40] = 30.0
/// >>> look = eye.look(sun, 10.0)
/// >>> look.percept.shape, look.display.dtype
/// ((48, 64, 3), dtype('uint8'))
/// >>> grey = eye.look(np.full_like(sun, 0.05), 0.1).percept
/// >>> bool(grey[24, 32, 1] < grey[0, 0, 1])
/// True
#[pyclass(module = "sungaze", name = "Eye", frozen)]
pub struct Eye {
    made: Made,
    watching: Mutex<Watching>,
}

/// What an eye is made of, to be made anew.
struct Made {
    config: Config,
    light: Light,
    size: [usize; 2],
    across: Degrees,
}

/// The eye, and the screen that follows what it sees.
struct Watching {
    eye: eye::Eye,
    screen: Screen,
    /// How often it has looked, or tried to.
    looks: u64,
}

/// What one look leaves.
struct Seen {
    look: eye::Look,
    map: ToneMap,
    number: u64,
}

impl Made {
    fn eye(&self) -> Looked<Watching> {
        let vision = self.light.received_by(self.config.observer())?;
        let eye = sungaze::run::eye_for(&self.config, vision, self.size, self.across)?;
        Ok(Watching { eye, screen: Screen::new(self.config.display()), looks: 0 })
    }
}

impl Watching {
    fn look(&mut self, frame: FrameView<'_>, gaze: Gaze, duration: Seconds) -> Looked<Seen> {
        self.looks += 1;
        let look = frame.seen_by(&mut self.eye, gaze, duration)?;
        let map = self.screen.follow(&look).clone();
        Ok(Seen { look, map, number: self.looks })
    }
}

#[pymethods]
impl Eye {
    #[new]
    #[pyo3(
        signature = (config=None, *, width, height, horizontal_fov_deg=None, white_cd_m2=None,
                     bands_nm=None),
        text_signature = "(config=None, *, width, height, horizontal_fov_deg=None, white_cd_m2=None, bands_nm=None)"
    )]
    fn new(
        config: Option<&Bound<'_, PyAny>>,
        width: i64,
        height: i64,
        horizontal_fov_deg: Option<f64>,
        white_cd_m2: Option<f64>,
        bands_nm: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Eye> {
        let config = config_of(config)?.for_given_frames().map_err(raised)?;
        let config = match white_cd_m2 {
            None => config,
            Some(white) => {
                let key = "input.white_cd_m2".to_owned();
                config.with(&[(key, Value::Float(white))]).map_err(raised)?
            }
        };
        let size = size_of(&config, width, height)?;
        let made = Made {
            light: light_of(&config, white_cd_m2, bands_nm)?,
            size,
            across: across_of(&config, horizontal_fov_deg, size[0])?,
            config,
        };
        fixed_gaze(&made.config)?;
        if made.config.scatter().psf != Psf::None {
            // What the eye scatters is worked out on the threads that all looks share.
            awake()?;
        }
        let watching = Mutex::new(made.eye().map_err(raised)?);
        Ok(Eye { made, watching })
    }

    /// Looks at a frame for a while; the state moves on by that time.
    ///
    /// Parameters
    /// ----------
    /// frame : array_like
    ///     Shape (h, w, 3), or (h, w, bands); float16, float32 or float64, any strides, and anything
    ///     with `__array__`. Finite.
    /// dt : float
    ///     How long, s, 0 or more. The frame is held over that time; the percept is that of its end.
    /// gaze : (float, float)
    ///     Where, in fractions of width and height from the top left; the configuration's `gaze.at`
    ///     otherwise, the middle without one.
    /// out : ndarray
    ///     (h, w, 3) float32, any strides: the percept is written there too.
    ///
    /// Returns
    /// -------
    /// Look
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     The frame has another shape or type, a sample is NaN or infinite, or `dt` is negative.
    #[pyo3(
        signature = (frame, dt, gaze=None, out=None),
        text_signature = "($self, frame, dt, gaze=None, out=None)"
    )]
    fn look<'py>(
        slf: Bound<'py, Self>,
        frame: &Bound<'py, PyAny>,
        dt: f64,
        gaze: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Look> {
        awake()?;
        let (py, this) = (slf.py(), slf.get());
        let [width, height] = this.made.size;
        let out = out.map(|out| writable(out, (height, width))).transpose()?;
        let gaze = gaze.map_or_else(|| fixed_gaze(&this.made.config), gaze_of)?;
        let seen = {
            let frame = Frame::of(frame)?;
            let view = frame.view();
            py.detach(|| this.watching()?.look(view, gaze, Seconds(dt)).map_err(raised))?
        };
        let Seen { look, map, number } = seen;
        Look::new(
            slf.clone().unbind(),
            py,
            look,
            (map, *this.watching()?.screen.display()),
            number,
            out,
        )
    }

    /// Unbleached fractions of L, M and S at the picture's places at the first gaze: (h, w, 3)
    /// float64, 1 where nothing is bleached.
    #[getter]
    fn unbleached<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let p = py.detach(|| Ok::<_, PyErr>(self.watching()?.eye.unbleached()))?;
        Ok(PyArray3::from_owned_array(py, p))
    }

    /// Everything that the next look depends on, for :meth:`restore`.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| {
            let watching = self.watching()?;
            let levels = watching.screen.map().map_or(Vec::new(), |map| map.levels().to_vec());
            let state = (self.made.size, watching.eye.state(), levels);
            postcard::to_allocvec(&state).map_err(|e| PyRuntimeError::new_err(e.to_string()))
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Goes on from a state that an eye of the same configuration and size has left.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     It is no such state; this eye's is kept.
    #[pyo3(text_signature = "($self, state)")]
    fn restore(&self, py: Python<'_>, state: &[u8]) -> PyResult<()> {
        py.detach(|| {
            let unknown = |_| refused("state", "other bytes", "what Eye.state() returned");
            let (size, state, levels): ([usize; 2], State, Vec<f64>) =
                postcard::from_bytes(state).map_err(unknown)?;
            if size != self.made.size {
                let found = format!("that of an eye of another size, {} x {}", size[0], size[1]);
                return Err(refused("state", found, "one of this eye's size"));
            }
            let mut watching = self.watching()?;
            let mut screen = watching.screen.clone();
            screen.restore(levels).map_err(raised)?;
            watching.eye.restore(state).map_err(raised)?;
            watching.screen = screen;
            watching.looks += 1;
            Ok(())
        })
    }

    /// Begins anew, with the pigment of `observer.start`.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            let anew = self.made.eye().map_err(raised)?;
            let mut watching = self.watching()?;
            let looks = watching.looks + 1;
            *watching = Watching { looks, ..anew };
            Ok(())
        })
    }
}

impl Eye {
    fn watching(&self) -> PyResult<MutexGuard<'_, Watching>> {
        let broken =
            "a look of this eye failed half-way, which is a defect of sungaze: make another";
        self.watching.lock().map_err(|_| PyRuntimeError::new_err(broken))
    }

    /// Cone illuminance of the look of that number, if it is still the latest.
    pub fn trolands_of(&self, number: u64) -> PyResult<numpy::ndarray::Array3<f32>> {
        let watching = self.watching()?;
        let latest = (watching.looks == number).then(|| watching.eye.trolands()).flatten();
        latest.ok_or_else(|| {
            refused("trolands", "a look before the latest", "the look that its eye had last")
        })
    }
}

fn light_of(
    config: &Config,
    white_cd_m2: Option<f64>,
    bands_nm: Option<&Bound<'_, PyAny>>,
) -> PyResult<Light> {
    let Some(bands_nm) = bands_nm else {
        let white = config.settings.input.white_cd_m2.ok_or_else(|| {
            let accepted = "the luminance of (1, 1, 1) in cd/m2, or bands_nm for spectral frames";
            refused("white_cd_m2", "none", accepted)
        })?;
        return Ok(Light::rgb(Primaries::REC709, Nits(white)));
    };
    if white_cd_m2.is_some() {
        let accepted = "white_cd_m2 for RGB frames, or bands_nm for spectral ones";
        return Err(refused("bands_nm", "both", accepted));
    }
    let centres: Option<Vec<f64>> = bands_nm.extract().ok();
    let bands = centres.and_then(|centres| Bands::from_centres(&centres));
    let accepted = "rising wavelengths in nm";
    Ok(Light::Bands(bands.ok_or_else(|| refused("bands_nm", described(bands_nm), accepted))?))
}

fn size_of(config: &Config, width: i64, height: i64) -> PyResult<[usize; 2]> {
    let most = config.settings.input.max_pixels;
    let pixels = |(w, h): (usize, usize)| w.checked_mul(h).is_some_and(|n| n as u64 <= most);
    let size = usize::try_from(width).ok().zip(usize::try_from(height).ok());
    match size.filter(|&(w, h)| w > 0 && h > 0 && pixels((w, h))) {
        Some((width, height)) => Ok([width, height]),
        None => {
            let accepted = format!("1 x 1 to input.max_pixels = {most} pixels");
            Err(refused("width, height", format!("{width} x {height}"), &accepted))
        }
    }
}

/// How wide frames of a width are, by the field of view and the projection.
fn across_of(config: &Config, given: Option<f64>, width: usize) -> PyResult<Degrees> {
    let accepted = "how many degrees the frames are across, 0.001 to 360; in perspective below 180";
    let input = &config.settings.input;
    let horizontal_fov_deg = given
        .or(input.horizontal_fov_deg)
        .ok_or_else(|| refused("horizontal_fov_deg", "none", accepted))?;
    let view = View { horizontal_fov_deg, projection: input.projection.unwrap_or_default() };
    let view = view.possible().filter(|_| (1e-3..=360.0).contains(&horizontal_fov_deg));
    let view = view.ok_or_else(|| refused("horizontal_fov_deg", horizontal_fov_deg, accepted))?;
    Ok(Degrees(width as f64 / view.pixels_per_degree(width)))
}

/// The gaze of a configuration, which must not wait for frames.
fn fixed_gaze(config: &Config) -> PyResult<Gaze> {
    let keys = &config.settings.gaze;
    match (&keys.path, keys.at) {
        (None, Aim::At(at)) => Ok(Gaze(at)),
        (path, _) => {
            let key = if path.is_some() { "gaze.path" } else { "gaze.at" };
            let problem = "has no meaning for frames in memory; accepted: gaze.at = [x, y], and the \
                           gaze of each look";
            Err(raised(config.wrong(key, problem)))
        }
    }
}

fn gaze_of(given: &Bound<'_, PyAny>) -> PyResult<Gaze> {
    let at: [f64; 2] = given.extract().map_err(|_| {
        refused("gaze", described(given), "(x, y), fractions of width and height from the top left")
    })?;
    Ok(Gaze(at))
}
