//! The sum of Gaussians that stands for a point spread function in a picture.
//!
//! The mixture over ln sigma ([`super::psf`]) is summed by the midpoint rule in steps of sqrt 2,
//! which for a power theta^(-n) errs by 2 |Gamma(n/2 + i pi/h)|/Gamma(n/2), h = ln(2)/2: at most
//! 3.4e-5. Gaussians narrower than the core stay in their pixel. Those wider than [`FAR`] diagonals
//! are their Taylor series over the picture.

use std::f64::consts::{LN_2, PI, SQRT_2};

use super::psf::{Formula, Term};

/// Step of ln sigma.
const STEP: f64 = 0.5 * LN_2;

/// Widest Gaussian that is summed as one, in diagonals of the picture: u = theta^2/(2 sigma^2) is
/// at most 1/32 for all wider ones, and e^(-u) within u^2/2 of 1 - u.
const FAR: f64 = 4.0;

/// Wider Gaussians that are added to the series: sqrt(2)^200 diagonals are as good as all.
const WIDER: usize = 200;

/// The narrowest Gaussian of a retina's own image, degrees: below the first term of the CIE
/// equation.
const FINEST_DEG: f64 = 0.004;

/// One Gaussian: standard deviation in pixels, and the share of the light that it spreads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub(crate) sigma: f64,
    pub(crate) weight: f64,
}

/// A point spread function per pixel at a distance r in pixels: the Gaussians + `constant` +
/// `quadratic` r^2, which is short of what it stands for by at most `quartic` r^4.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Gaussians {
    pub(crate) nodes: Vec<Node>,
    pub(crate) constant: f64,
    pub(crate) quadratic: f64,
    pub(crate) quartic: f64,
}

impl Gaussians {
    /// The Gaussians of a formula at least as wide as `core` degrees, for a picture of so many
    /// degrees a pixel and pixels along its diagonal.
    pub(super) fn new(formula: &Formula, core: f64, degrees: f64, diagonal: f64) -> Gaussians {
        let narrowest = core.max(0.5 * degrees).max(FINEST_DEG);
        let sigma = |j: usize| narrowest * (STEP * (j as f64 + 0.5)).exp();
        let count = (0..).take_while(|j| sigma(*j) < FAR * diagonal * degrees).count();
        let pixel = degrees.to_radians().powi(2);
        let node = |sigma: f64, height: f64| {
            let weight = 2.0 * PI * sigma.to_radians().powi(2) * height;
            Node { sigma: sigma / degrees, weight }
        };
        let mut nodes: Vec<Node> =
            (0..count).map(|j| node(sigma(j), STEP * formula.mixture(sigma(j)))).collect();
        nodes.extend(formula.terms.iter().filter_map(|term| match *term {
            Term::Gaussian { height, sigma } if sigma >= narrowest => Some(node(sigma, height)),
            _ => None,
        }));
        let quadratic = pixel * formula.quadratic * degrees * degrees;
        let mut sum =
            Gaussians { nodes, constant: pixel * formula.constant, quadratic, quartic: 0.0 };
        for sigma in (count..count + WIDER).map(sigma) {
            let (height, series) =
                (pixel * STEP * formula.mixture(sigma), 0.5 * (degrees / sigma).powi(2));
            sum.constant += height;
            sum.quadratic -= height * series;
            sum.quartic += 0.5 * height * series * series;
        }
        sum
    }

    /// All of it times a factor.
    pub(super) fn times(mut self, factor: f64) -> Gaussians {
        self.nodes.iter_mut().for_each(|node| node.weight *= factor);
        Gaussians {
            constant: factor * self.constant,
            quadratic: factor * self.quadratic,
            quartic: factor * self.quartic,
            ..self
        }
    }

    /// The share of the light that goes over the hemisphere, at so many degrees a pixel.
    pub(super) fn over_the_hemisphere(&self, degrees: f64) -> f64 {
        const RINGS: usize = 4000;
        let (nearest, farthest) = (1e-4f64, 90.0f64);
        let step = (farthest / nearest).ln() / RINGS as f64;
        let ring = |i: usize| {
            let theta = nearest * (step * (i as f64 + 0.5)).exp();
            let area = 2.0 * PI * theta.to_radians().sin() * theta.to_radians() * step;
            area * self.density(theta / degrees) / degrees.to_radians().powi(2)
        };
        (0..RINGS).map(ring).sum()
    }

    /// The sum of the Gaussians themselves at a distance in pixels, per pixel.
    pub(super) fn density(&self, r: f64) -> f64 {
        let height = |node: &Node| node.weight / (2.0 * PI * node.sigma * node.sigma);
        let bell = |node: &Node| height(node) * (-0.5 * (r / node.sigma).powi(2)).exp();
        self.nodes.iter().map(bell).sum::<f64>() + self.constant + self.quadratic * r * r
    }

    /// The share of the light that goes to a pixel so far away in x and y: the truth of the
    /// pyramid.
    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        let r2 = x * x + y * y;
        let sum: f64 =
            self.nodes.iter().map(|n| n.weight * sampled(n.sigma, x) * sampled(n.sigma, y)).sum();
        sum + self.constant + self.quadratic * r2
    }
}

/// A Gaussian of one dimension at whole numbers, which sums to 1 over all of them.
pub(super) fn sampled(sigma: f64, x: f64) -> f64 {
    let bell = |x: f64| (-0.5 * (x / sigma).powi(2)).exp();
    // Poisson: samples of a Gaussian this wide add up to its integral within 2 e^(-2 (pi sigma)^2) = 5e-20.
    let sum = if sigma > 1.5 {
        SQRT_2 * PI.sqrt() * sigma
    } else {
        (-12..=12).map(|i| bell(f64::from(i))).sum()
    };
    bell(x) / sum
}
