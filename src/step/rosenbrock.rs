//! Rosenbrock methods: implicit in the slope at the step's start, so that no iteration is needed.
//!
//! ```text
//! (1/(gamma h) - J) u_i = p'(p + sum_j<i a_ij u_j, t + alpha_i h) + sum_j<i (c_ij/h) u_j + gamma_i h dp'/dt
//! p1 = p + sum m_i u_i,        J = d p'/dp at the start
//! ```
//!
//! Where light comes up inside the step, J was taken in the dark and protects from nothing (Hairer
//! & Wanner 1996, IV.7; the coefficients are in their form without matrix products).

use super::Drive;
use crate::kinetics::Kinetics;
use crate::units::{Seconds, Trolands};
use std::f64::consts::FRAC_1_SQRT_2;

/// Coefficients of a Rosenbrock method.
pub struct Rosenbrock<const S: usize> {
    pub gamma: f64,
    pub a: [[f64; S]; S],
    pub c: [[f64; S]; S],
    pub alpha: [f64; S],
    pub gammas: [f64; S],
    pub m: [f64; S],
}

/// One linearly implicit step.
#[inline]
pub fn linearly_implicit<const S: usize>(
    method: &Rosenbrock<S>,
    kinetics: &Kinetics,
    p: f64,
    drive: Drive,
    dt: Seconds,
) -> f64 {
    let (h, light) = (dt.0, drive.at(0.0));
    let pivot = 1.0 / (method.gamma * h) - kinetics.slope(p, light);
    // p' is linear in the light, so its drift over the step is a difference of two slopes.
    let risen = Trolands(light.0 + drive.initial_rise().0);
    let drift = kinetics.change(p, risen) - kinetics.change(p, light);
    let mut u = [0.0; S];
    for i in 0..S {
        let stage = (0..i).fold(p, |sum, j| sum + method.a[i][j] * u[j]);
        let earlier = (0..i).fold(0.0, |sum, j| sum + method.c[i][j] * u[j]) / h;
        let slope = kinetics.change(stage, drive.at(method.alpha[i]));
        u[i] = (slope + earlier + method.gammas[i] * drift) / pivot;
    }
    (0..S).fold(p, |sum, i| sum + method.m[i] * u[i])
}

/// gamma = 1 + 1/sqrt 2, the choice that keeps R positive.
const GAMMA: f64 = 1.0 + FRAC_1_SQRT_2;

pub(super) const ROS2: Rosenbrock<2> = Rosenbrock {
    gamma: GAMMA,
    a: [[0.0, 0.0], [1.0 / GAMMA, 0.0]],
    c: [[0.0, 0.0], [-2.0 / GAMMA, 0.0]],
    alpha: [0.0, 1.0],
    gammas: [GAMMA, -GAMMA],
    m: [1.5 / GAMMA, 0.5 / GAMMA],
};

pub(super) const RODAS4: Rosenbrock<6> = Rosenbrock {
    gamma: 0.25,
    a: [
        [0.0; 6],
        [1.544, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.9466785280815826, 0.2557011698983284, 0.0, 0.0, 0.0, 0.0],
        [3.314825187068521, 2.896124015972201, 0.9986419139977817, 0.0, 0.0, 0.0],
        [1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895, 0.0, 0.0],
        [1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895, 1.0, 0.0],
    ],
    c: [
        [0.0; 6],
        [-5.6688, 0.0, 0.0, 0.0, 0.0, 0.0],
        [-2.430093356833875, -0.2063599157091915, 0.0, 0.0, 0.0, 0.0],
        [-0.1073529058151375, -9.594562251023355, -20.47028614809616, 0.0, 0.0, 0.0],
        [7.496443313967647, -10.24680431464352, -33.99990352819905, 11.7089089320616, 0.0, 0.0],
        [
            8.083246795921522,
            -7.981132988064893,
            -31.52159432874371,
            16.31930543123136,
            -6.058818238834054,
            0.0,
        ],
    ],
    alpha: [0.0, 0.386, 0.21, 0.63, 1.0, 1.0],
    gammas: [0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0],
    m: [1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895, 1.0, 1.0],
};

/// R(-x) of Rodas4: (1 + x/4)^6 e^-x up to x^4 by its order; the fifth coefficient follows from the
/// tableau.
pub(super) fn rodas4_damping(x: f64) -> f64 {
    const FIFTH: f64 = 0.00215865480625998;
    let numerator =
        1.0 + x * (0.5 + x * (-1.0 / 16.0 + x * (-1.0 / 24.0 + x * (5.0 / 768.0 + x * FIFTH))));
    numerator / (1.0 + 0.25 * x).powi(6)
}
