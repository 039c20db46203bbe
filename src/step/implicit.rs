//! Implicit Runge-Kutta methods: the slopes k_i = p'(p + h sum_j a_ij k_j, t + c_i h) solved for
//! together.
//!
//! One Newton step solves a linear law; the others iterate from the slopes of a linear law. R(-x)
//! is rational: nothing here blows up under held light, but most let R turn negative, and pigment
//! with it (Hairer & Wanner 1996).

use super::Drive;
use crate::kinetics::{Kinetics, Law};
use crate::units::Seconds;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Coefficients of an implicit Runge-Kutta method.
pub struct Implicit<const S: usize> {
    pub a: [[f64; S]; S],
    pub b: [f64; S],
    pub c: [f64; S],
}

/// Newton steps after which a nonlinear stage equation is given up; convergence takes 2 to 6.
const MOST_ITERATIONS: usize = 40;

/// One implicit step.
#[inline(always)]
pub fn collocate<const S: usize>(
    tableau: &Implicit<S>,
    kinetics: &Kinetics,
    p: f64,
    drive: Drive,
    dt: Seconds,
) -> f64 {
    let mut k = newton(tableau, kinetics, p, drive, dt, [0.0; S]);
    if kinetics.law != Law::FirstOrder {
        k = converged(tableau, kinetics, p, drive, dt, k);
    }
    p + dt.0 * (0..S).fold(0.0, |sum, i| sum + tableau.b[i] * k[i])
}

/// Newton steps until one is so short that its square, the error left, is below rounding.
#[inline(never)]
fn converged<const S: usize>(
    tableau: &Implicit<S>,
    kinetics: &Kinetics,
    p: f64,
    drive: Drive,
    dt: Seconds,
    mut k: [f64; S],
) -> [f64; S] {
    for _ in 0..MOST_ITERATIONS {
        let next = newton(tableau, kinetics, p, drive, dt, k);
        let moved = (0..S).fold(0.0, |most: f64, i| most.max((dt.0 * (next[i] - k[i])).abs()));
        k = next;
        if moved < 1e-9 {
            break;
        }
    }
    k
}

/// One Newton step for all slopes together.
#[inline(always)]
fn newton<const S: usize>(
    tableau: &Implicit<S>,
    kinetics: &Kinetics,
    p: f64,
    drive: Drive,
    dt: Seconds,
    k: [f64; S],
) -> [f64; S] {
    let mut system = [[0.0; S]; S];
    let mut residual = [0.0; S];
    for i in 0..S {
        let stage = p + dt.0 * (0..S).fold(0.0, |sum, j| sum + tableau.a[i][j] * k[j]);
        let light = drive.at(tableau.c[i]);
        let slope = dt.0 * kinetics.slope(stage, light);
        residual[i] = kinetics.change(stage, light) - k[i];
        system[i] = tableau.a[i].map(|a| -slope * a);
        system[i][i] += 1.0;
    }
    let correction = solve(system, residual);
    std::array::from_fn(|i| k[i] + correction[i])
}

/// Solve a small linear system by elimination; the pivots of I - h f' A are safe as they stand,
/// because f' <= 0.
#[inline(always)]
fn solve<const S: usize>(mut a: [[f64; S]; S], mut b: [f64; S]) -> [f64; S] {
    for column in 0..S {
        for row in column + 1..S {
            let factor = a[row][column] / a[column][column];
            (column..S).for_each(|j| a[row][j] -= factor * a[column][j]);
            b[row] -= factor * b[column];
        }
    }
    for row in (0..S).rev() {
        let known = (row + 1..S).fold(0.0, |sum, j| sum + a[row][j] * b[j]);
        b[row] = (b[row] - known) / a[row][row];
    }
    b
}

pub(super) const BACKWARD_EULER: Implicit<1> = Implicit { a: [[1.0]], b: [1.0], c: [1.0] };

pub(super) const TRAPEZOID: Implicit<2> =
    Implicit { a: [[0.0, 0.0], [0.5, 0.5]], b: [0.5, 0.5], c: [0.0, 1.0] };

/// Half a trapezoid step to 2 - sqrt 2, then BDF2, as one Runge-Kutta method.
pub(super) const TR_BDF2: Implicit<3> = Implicit {
    a: [
        [0.0, 0.0, 0.0],
        [1.0 - FRAC_1_SQRT_2, 1.0 - FRAC_1_SQRT_2, 0.0],
        [SQRT_2 / 4.0, SQRT_2 / 4.0, 1.0 - FRAC_1_SQRT_2],
    ],
    b: [SQRT_2 / 4.0, SQRT_2 / 4.0, 1.0 - FRAC_1_SQRT_2],
    c: [0.0, 2.0 - SQRT_2, 1.0],
};

pub(super) const LOBATTO_IIIC_2: Implicit<2> =
    Implicit { a: [[0.5, -0.5], [0.5, 0.5]], b: [0.5, 0.5], c: [0.0, 1.0] };

/// sqrt 6, for the nodes of Radau IIA.
const ROOT_6: f64 = 2.449489742783178;

pub(super) const RADAU_IIA_5: Implicit<3> = Implicit {
    a: [
        [
            (88.0 - 7.0 * ROOT_6) / 360.0,
            (296.0 - 169.0 * ROOT_6) / 1800.0,
            (-2.0 + 3.0 * ROOT_6) / 225.0,
        ],
        [
            (296.0 + 169.0 * ROOT_6) / 1800.0,
            (88.0 + 7.0 * ROOT_6) / 360.0,
            (-2.0 - 3.0 * ROOT_6) / 225.0,
        ],
        [(16.0 - ROOT_6) / 36.0, (16.0 + ROOT_6) / 36.0, 1.0 / 9.0],
    ],
    b: [(16.0 - ROOT_6) / 36.0, (16.0 + ROOT_6) / 36.0, 1.0 / 9.0],
    c: [(4.0 - ROOT_6) / 10.0, (4.0 + ROOT_6) / 10.0, 1.0],
};
