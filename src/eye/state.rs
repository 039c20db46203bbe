//! The state of an eye: everything that its next look depends on.

use serde::{Deserialize, Serialize};

use super::check::Check;
use super::plan::Plan;
use super::retina::Retina;
use super::{Eye, Surround};
use crate::error::{Error, Result};
use crate::observer::Pupil;
use crate::units::Nits;

/// What an eye carries from look to look.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    size: [usize; 2],
    retina: Retina,
    pupil: Pupil,
    plan: Plan,
    check: Option<Check>,
    first_gaze: Option<[f64; 2]>,
    /// None before the first look tells.
    surround: Option<Nits>,
}

impl State {
    /// The same with another retina, alike beyond the picture.
    pub fn with_retina(self, retina: Retina) -> State {
        let retina = retina.with_cells(self.retina.extent());
        State { retina, ..self }
    }
}

impl Eye {
    /// The state, to be given to [`Eye::restore`].
    pub fn state(&self) -> State {
        State {
            size: self.size,
            retina: self.retina.clone(),
            pupil: self.pupil.clone(),
            plan: self.plan.clone(),
            check: self.check.clone(),
            first_gaze: self.first_gaze,
            surround: self.surround.known(),
        }
    }

    /// Goes on from a state that an eye of the same observer, light and size has left.
    ///
    /// # Errors
    /// The state is of another size, plan or pupil, or holds fractions outside 0..1.
    pub fn restore(&mut self, state: State) -> Result<()> {
        let State { size, retina, pupil, plan, check, first_gaze, surround } = state;
        let covers = (0..2).all(|i| {
            let first = -retina.origin()[i];
            first >= 0 && first as usize + self.size[i] <= retina.size()[i]
        });
        let known = first_gaze.is_none_or(|at| at.iter().all(|v| v.is_finite()))
            && surround.map_or(first_gaze.is_none(), |nits| nits.0 >= 0.0);
        let fits = check.as_ref().is_none_or(|check| check.is_sound(self.size));
        let cells = retina.has_cells(self.retina.extent());
        if !(size == self.size && retina.is_sound() && covers && cells && known && fits) {
            return Err(Error::light("the state is of an eye of another size, or damaged"));
        }
        if !self.plan.fits(&plan, retina.size()[1]) || !self.pupil.fits(&pupil) {
            return Err(Error::light("the state is of an eye with another plan or pupil"));
        }
        self.retina = retina;
        self.pupil = pupil;
        self.plan = plan;
        self.check = check;
        self.first_gaze = first_gaze;
        self.surround = surround.map_or(Surround::Edge, Surround::Uniform);
        Ok(())
    }
}
