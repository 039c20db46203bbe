//! Published constants of cone pigment kinetics, by name. They disagree by a factor of five in the
//! half-bleach light, which moves the steady unbleached fraction by up to 0.38: far more than any
//! numerical error. That is why they are a parameter.

/// A named set. L, M, S in that order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConstantSet {
    pub(crate) name: &'static str,
    /// log10 of the light, td, that keeps half of the pigment bleached (rate-limited: log10 of
    /// Q/tau).
    pub(crate) half_bleach_log_td: [f64; 3],
    /// Time constant of regeneration, s.
    pub(crate) tau_s: [f64; 3],
    /// `first-order` or `rate-limited`.
    pub(crate) law: &'static str,
    /// Saturation of the rate-limited law; unused by the other.
    pub(crate) km: f64,
    pub(crate) source: &'static str,
}

const fn first_order(
    name: &'static str,
    half_bleach_log_td: [f64; 3],
    tau_s: f64,
    source: &'static str,
) -> ConstantSet {
    ConstantSet { name, half_bleach_log_td, tau_s: [tau_s; 3], law: "first-order", km: 0.2, source }
}

/// Every set that `observer.constants` knows. Where a source gives no S cone, S has equal
/// photosensitivity per molecule: its half-bleach light is larger by the ratio of one cone
/// troland's quanta, about 0.7 in log10.
pub(crate) const CONSTANTS: &[ConstantSet] = &[
    first_order(
        "standard",
        [4.3, 4.3, 5.0],
        120.0,
        "Rushton & Henry 1968 via CVRL; Boynton & Kaiser; S derived",
    ),
    first_order(
        "paper",
        [3.89, 3.89, 3.89],
        120.0,
        "Gutierrez et al. 2005, Table 1 (L and M after Rushton 1972; it has no S and no tau). CVRL calls 3.89 questionable",
    ),
    first_order(
        "mixture",
        [4.3, 4.3, 4.3],
        120.0,
        "Gutierrez et al. 2005, Table 1, L+M row, for all three",
    ),
    first_order(
        "rushton-henry-alt",
        [4.464_891_76, 4.464_891_76, 5.16],
        120.0,
        "Rushton & Henry 1968, the other method: 29 167 td; S derived",
    ),
    first_order(
        "wyszecki-stiles",
        [4.585_026_65, 4.585_026_65, 5.28],
        130.0,
        "Wyszecki & Stiles 1982: Q = 5e6 td s, tau 130 s, hence 38 462 td; S derived",
    ),
    first_order(
        "hollins-alpern",
        [4.3, 4.3, 5.0],
        105.0,
        "Hollins & Alpern 1973 (tau reported second-hand); S derived",
    ),
    ConstantSet {
        name: "van-hateren-snippe",
        half_bleach_log_td: [3.742_603_65, 3.742_603_65, 4.441_573_65],
        tau_s: [150.0; 3],
        law: "rate-limited",
        km: 0.2,
        source: "van Hateren & Snippe 2007: v = 0.008/s, K = 0.2, Q = 829 268 td s; S five times",
    },
];

/// Rods, for `validate` and the pigment chart: log10 of scotopic trolands, and s (paper Table 1;
/// Rushton 1972 via CVRL).
pub(crate) const RODS: (f64, f64) = (4.4, 400.0);

/// The set of a name.
pub(crate) fn named(name: &str) -> Option<&'static ConstantSet> {
    CONSTANTS.iter().find(|set| set.name == name)
}

/// The set where none is named.
pub(crate) const STANDARD: &ConstantSet = &CONSTANTS[0];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_bleach_lights_are_the_published_ones() {
        let td =
            |name: &str, cone: usize| 10f64.powf(named(name).unwrap().half_bleach_log_td[cone]);
        for (name, cone, published) in [
            ("rushton-henry-alt", 0, 29_167.0),
            ("wyszecki-stiles", 0, 5e6 / 130.0),
            ("van-hateren-snippe", 0, 829_268.0 / 150.0),
            ("van-hateren-snippe", 2, 5.0 * 829_268.0 / 150.0),
        ] {
            assert!((td(name, cone) / published - 1.0).abs() < 1e-5, "{name}: {}", td(name, cone));
        }
    }
}
