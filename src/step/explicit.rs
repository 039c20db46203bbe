//! Explicit Runge-Kutta methods: p1 = p + h sum b_i k_i, k_i = p'(p + h sum_j<i a_ij k_j, t + c_i
//! h).
//!
//! R(-x) is a polynomial, so every one of them blows up once h lambda passes 2 to 3.3 (Hairer &
//! Wanner 1996, IV.2).

use super::Drive;
use crate::kinetics::Kinetics;
use crate::units::Seconds;

/// Coefficients of an explicit Runge-Kutta method; c_i is the sum of row a_i.
pub(crate) struct Explicit<const S: usize> {
    a: [[f64; S]; S],
    pub(crate) b: [f64; S],
    c: [f64; S],
}

/// The slopes k_i of one step.
#[inline]
pub(super) fn slopes<const S: usize>(
    tableau: &Explicit<S>,
    kinetics: &Kinetics,
    p: f64,
    drive: Drive,
    dt: Seconds,
) -> [f64; S] {
    let mut k = [0.0; S];
    for i in 0..S {
        let stage = (0..i).fold(0.0, |sum, j| sum + tableau.a[i][j] * k[j]);
        k[i] = kinetics.change(p + dt.0 * stage, drive.at(tableau.c[i]));
    }
    k
}

/// One explicit step.
#[inline]
pub(crate) fn runge_kutta<const S: usize>(
    tableau: &Explicit<S>,
    kinetics: &Kinetics,
    p: f64,
    drive: Drive,
    dt: Seconds,
) -> f64 {
    let k = slopes(tableau, kinetics, p, drive, dt);
    p + dt.0 * (0..S).fold(0.0, |sum, i| sum + tableau.b[i] * k[i])
}

pub(super) const FORWARD_EULER: Explicit<1> = Explicit { a: [[0.0]], b: [1.0], c: [0.0] };

pub(super) const HEUN: Explicit<2> =
    Explicit { a: [[0.0, 0.0], [1.0, 0.0]], b: [0.5, 0.5], c: [0.0, 1.0] };

pub(super) const RK4: Explicit<4> = Explicit {
    a: [[0.0; 4], [0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
    b: [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    c: [0.0, 0.5, 0.5, 1.0],
};

/// The fifth-order weights; the seventh stage serves the error estimate of the adaptive form only.
pub(super) const DORMAND_PRINCE: Explicit<6> = Explicit {
    a: [
        [0.0; 6],
        [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
        [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
        [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
        [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    ],
    b: [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
    c: [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0],
};
