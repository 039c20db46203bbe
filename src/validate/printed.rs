//! Where the paper as printed disagrees with its own sources: ours is measured, the printed number
//! stands beside it.

use crate::constants::named;
use crate::error::Result;
use crate::observer::{Adapting, Rule};
use crate::units::{Millimetres, Nits};

use super::{Check, PAPER, Subject};

pub(super) fn checks(subject: &Subject) -> Result<Vec<Check>> {
    let mut checks = pupils();
    checks.push(luminance_twice(subject)?);
    checks.push(half_bleaches());
    checks.push(lens_twice(subject)?);
    Ok(checks)
}

/// The unit shift of both pupil formulas has the wrong sign.
fn pupils() -> Vec<Check> {
    let pairs = [
        (
            "Moon & Spencer",
            Rule::MoonSpencer,
            Rule::MoonSpencerAsPrinted,
            "Eq. 3: log La + 1.0, not log La",
        ),
        (
            "de Groot & Gebhard",
            Rule::DeGrootGebhard,
            Rule::DeGrootGebhardAsPrinted,
            "Eq. 4: 8.6, not 7.6",
        ),
    ];
    let at = |rule: Rule, nits: f64| {
        rule.diameter(Adapting {
            fovea: Nits(nits),
            picture: Nits(nits),
            area_deg2: 36.0,
            surround: Nits(0.0),
        })
        .0
    };
    let of_pair = |(name, published, printed, source)| {
        [1.0, 100.0].map(|nits| {
            let what = format!("pupil, mm, {nits} cd/m2, {name}: published, as printed");
            Check::info(what, source, at(published, nits), at(printed, nits))
        })
    };
    pairs.into_iter().flat_map(of_pair).collect()
}

/// Eq. 7 multiplies a spectral luminance, which holds V already, by a cone's sensitivity.
fn luminance_twice(subject: &Subject) -> Result<Check> {
    let eye = subject.observer(PAPER)?;
    let v = eye.luminous_efficiency();
    let l = eye.fundamentals.unbleached(0);
    let ours = eye.cone_troland()[0] * l.integral() / v.integral();
    let printed = v.times(l).integral() / v.integral();
    Ok(Check::info(
        "L td of one equal-energy td: V once, V twice",
        "Eq. 2 and 7 count V(lambda) twice",
        ours,
        printed,
    ))
}

/// Table 1 gives two values that differ by a factor of 2.6.
fn half_bleaches() -> Check {
    let log_td = |set: &str| named(set).map_or(f64::NAN, |set| set.half_bleach_log_td[0]);
    let source = "Table 1: L+M row, L and M rows";
    Check::info(
        "half-bleach of L, log10 td: L+M row, L row",
        source,
        log_td("mixture"),
        log_td("paper"),
    )
}

/// Fig. 2's correction for the lens, on fundamentals that are measured at the cornea, counts the
/// lens twice.
fn lens_twice(subject: &Subject) -> Result<Check> {
    let (measured, corrected) = (
        subject.observer(&format!("{PAPER}\nobserver.stiles_crawford_p = \"measured\""))?,
        subject.observer(PAPER)?,
    );
    let s = |eye: &crate::observer::Observer| {
        eye.equal_energy_weight(Millimetres(8.0), Millimetres(4.0))[2]
    };
    let source = "Fig. 2 corrects for the lens";
    Ok(Check::info(
        "eta of S at 4 mm: measured, corrected for the lens",
        source,
        s(&measured),
        s(&corrected),
    ))
}
