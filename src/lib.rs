//! What a person sees while staring at a bright light.
//!
//! Frames go in, spectral or RGB, scene-linear, in absolute units. At every place on the retina the
//! photopigment of the L, M and S cones bleaches and regenerates by an ordinary differential
//! equation, frame after frame. Out comes the picture that this tired eye perceives. The README
//! shows the program; these pages are about the library.
//!
//! ```
//! # use ndarray::Array3;
//! use sungaze::colour::Primaries;
//! use sungaze::display::Screen;
//! use sungaze::eye::{Eye, Gaze, Light};
//! use sungaze::units::{Degrees, Nits, Seconds};
//!
//! # let (width, height) = (96, 54);
//! # let frames = [const { () }; 24].map(|()| Array3::<f32>::ones((height, width, 3)));
//! let light = Light::rgb(Primaries::REC709, Nits(5000.0)); // the luminance of (1, 1, 1)
//! let mut eye = Eye::new(light, [width, height], Degrees(40.0))?;
//! let mut screen = Screen::default();
//! let mut srgb = vec![0; 3 * width * height];
//! for frame in &frames {
//!     let look = eye.look(frame.view(), Gaze::CENTRE, Seconds(1.0 / 24.0))?; // (h, w, 3), f32 or f16
//!     screen.show(&look, &mut srgb)?; // look.percept is what is seen, scene-linear
//! }
//! assert!(eye.unbleached()[[27, 48, 0]] < 1.0); // of L, M and S: (h, w, 3)
//! # Ok::<(), sungaze::error::Error>(())
//! ```
//!
//! # The path of a frame
//!
//! ```text
//! frames::Footage      a file is decoded block by block; spectral blocks are projected at once
//!   light::Planes      the frame: RGB in the file's own numbers, or the projections of its spectra
//!   light::Survey      its luminances: the pupil's and the display's view of it
//!   eye::Eye::look_at  the stages, in eye/stages.rs:
//!     optics           light -> light on the retina
//!     pupil            adapting luminance -> diameter
//!     illuminance      light x pupil x Stiles-Crawford weight -> trolands in each class of cones
//!     pigment          trolands move the unbleached fraction p: kinetics (which law), step (how)
//!     catch            light seen through what pigment is left
//!     percept          catches -> the picture's own RGB; the light itself where none is bleached
//!   display::Screen    unbleached light -> tone map (slow); percept -> sRGB
//!   frames::write_exr, write_png
//! ```
//!
//! # Where things live
//!
//! Each room uses only those above it; `tests/rooms.rs` reads this table and keeps that true.
//!
//! | room | holds | to add |
//! |---|---|---|
//! | [`units`], [`error`], [`text`] | one-field unit types; the one error enum; text for people | |
//! | [`spectrum`], [`colour`] | wavelengths and tables; primaries and 3x3 matrices | a published table: a CSV in `data/` and a line in [`spectrum`] |
//! | [`light`] | planes, rows and tiles of a frame, its luminances | |
//! | `constants` | published constants by name | a row |
//! | [`observer`] | fundamentals, pupil, Stiles-Crawford effect | a pupil formula: a variant of [`observer::Rule`] |
//! | [`kinetics`] | the laws, as two rates | a variant of [`kinetics::Law`], in its `NAMES` |
//! | [`step`] | the methods, as pure functions with a row of theory each | one function and one row of [`step::METHODS`] |
//! | [`kernel`] | loops on plain arrays: the only room where speed is written, and `unsafe` allowed | |
//! | [`vision`] | one linear operator: projections of light, illuminance, catches; the scalar truth | |
//! | [`optics`] | light scattered in the eye: point spread functions, their Gaussians on a pyramid, the certificate | a function: a variant of [`optics::Psf`] |
//! | [`eye`] | the core: an eye in time, its stages, retina, plan and check | a stage: its file, its place in `stages.rs` or, within a tile, `percept.rs`, a setter in `builder.rs`, which `run::eye_for` calls with its key |
//! | [`display`] | tone reproduction, gamut, encoding | |
//! | [`frames`] | files in and out, the built-in scene | a format: a file with a `FORMAT`, and two lines in `frames/mod.rs` |
//! | `plot` | figures: axes, palette, lines and words, as SVG and PNG | |
//! | [`config`] | TOML -> everything above | a key: a field in `config/settings`, a range in `check.rs` |
//! | `page` | `report.html` and the live page: one HTML file | a panel: a script in `page/`, a line in `page` |
//! | [`run`] | the loop: reader, eye, writer; checkpoints, report | |
//! | [`view`] | the same loop, live: a server, a page, and a path that can be gone back along | |
//! | [`sweep`] | cases and durations, their table and contact sheet | |
//! | [`validate`] | what the program computes beside what it should | a check: a row in the file of its topic |
//! | [`chart`] | the charts that the program makes of itself | a file and a row of [`chart::CHARTS`] |
//!
//! # Invariants
//!
//! Kept by tests, and worth keeping in mind when changing anything:
//!
//! * An unbleached retina returns its input exactly, bit for bit, at any gaze.
//! * p stays within 0..1; with the exact step it does so without a clamp.
//! * The state is never resampled: light is brought to the retina and p is read at the picture's
//!   points.
//! * Nothing depends on the number of threads, bit for bit.
//! * A plan promises only what its bound covers.
//! * Memory does not grow with the number of frames, and a look allocates only where the retina
//!   grows. Files appear whole or not at all.
//! * Below [`eye`] nothing loops over pixels but [`kernel`] and [`optics`]; below [`frames`] nothing
//!   touches a file.
//! * `exr` and `zune-jpeg` are named in [`frames`] only, `zeno` and `ttf-parser` in `plot` only, `toml`
//!   in [`config`] only, `clap` in the program only.
//! * The library never prints, never exits, and never unwraps what a user gave.
//!
//! # What is decided where the sources are silent
//!
//! *One luminance everywhere*: cd/m2 are what a photometer reads of D65; V is the Y row of the
//! observer's own LMS -> XYZ, and K makes the two agree (`observer::Photometry`). With 2 degrees
//! equal energy reads 1.0007 of what CIE 1931 says, a 2900 K lamp .996, the low sun 1.013. *One
//! colour space*: one matrix from catches to the percept, for light of every kind; RGB is re-mixed so
//! that unbleached it is itself. *One cone troland*: an equal-energy light of 1 td gives 1 in every
//! class of a 32-year-old (`observer::Observer::cone_troland`), and as much less in an older eye
//! as its lens keeps back (`observer::Observer::aged`); multiplying a luminance by a fundamental,
//! as the paper of 2005 writes it, would count V twice. The effect of the pupil's margin (Stiles-Crawford)
//! enters the trolands only, never the percept.

pub mod chart;
pub mod colour;
pub mod config;
pub(crate) mod constants;
pub mod display;
pub mod error;
pub mod eye;
pub mod frames;
pub mod kernel;
pub mod kinetics;
pub mod light;
pub mod observer;
pub mod optics;
#[doc = include_str!("paper.md")]
pub(crate) mod paper {}
pub(crate) mod page;
pub(crate) mod plot;
pub mod run;
pub mod spectrum;
pub mod step;
pub mod sweep;
pub mod text;
pub mod units;
pub mod validate;
#[cfg(feature = "view")]
pub mod view;
pub mod vision;
