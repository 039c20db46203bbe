"""The law on arrays: against the oracle, closed forms and published numbers."""

import csv

import numpy as np
import pytest
import sungaze

HELD = ["held", "dark", "sun-glance", "flicker-12Hz"]


def schedule(words):
    """`hold:<td>:<s>` parts, or `<n>*(...)` of them."""
    if "*(" in words:
        count, inner = words.split("*(")
        return schedule(inner.rstrip(")")) * int(count)
    return [tuple(map(float, part.split(":")[1:])) for part in words.split(" ")]


def oracle(case):
    with open("data/kinetics_oracle.csv") as table:
        return [row for row in csv.DictReader(table) if row["case"] == case]


def end_of(row, **law):
    p = float(row["p0"])
    for trolands, seconds in schedule(row["schedule"]):
        p = sungaze.unbleached(trolands, seconds, p, np.log10(float(row["I0_td"])),
                               float(row["tau_s"]), **law)
    return p


@pytest.mark.parametrize("case", HELD)
def test_the_oracle_within_1e_14(case):
    rows = oracle(case)
    assert rows
    for row in rows:
        assert abs(end_of(row) - float(row["p"])) <= 1e-14, row


def test_the_rate_limited_oracle_within_the_stated_bound():
    for row in oracle("dark-enzyme") + oracle("enzyme-light"):
        p = end_of(row, law="rate-limited", km=float(row["Km"]))
        assert abs(p - float(row["p"])) <= 1e-6, row


def test_a_whole_array_at_once_is_each_value_by_itself():
    td = np.geomspace(1, 1e9, 40)[:, None]
    seconds = np.linspace(0, 300, 30)
    together = sungaze.unbleached(td, seconds, start=0.4)
    assert together.shape == (40, 30)
    each = [[sungaze.unbleached(i, t, start=0.4) for t in seconds] for i in td[:, 0]]
    assert np.array_equal(together, each)


def test_every_argument_broadcasts_and_any_strides_will_do():
    rng = np.random.default_rng(1)
    td, seconds = rng.uniform(0, 1e6, (7, 300, 3)), rng.uniform(0, 100, (300, 1))
    half_bleach, tau = np.array([4.3, 4.3, 5.0]), 120.0
    start = np.asfortranarray(rng.uniform(0, 1, (7, 300, 3)))[::-1]
    found = sungaze.unbleached(td, seconds, start, half_bleach, tau)
    a = 1 + td / 10**half_bleach
    expected = 1 / a + np.exp(-seconds / tau * a) * (start - 1 / a)
    np.testing.assert_allclose(found, expected, rtol=0, atol=4e-16)


def test_scalars_give_a_float():
    assert type(sungaze.unbleached(1e4, 10)) is float
    assert type(sungaze.steady(1e4)) is float


@pytest.mark.parametrize("law", ["first-order", "self-screened", "rate-limited"])
def test_for_ever_is_steady(law):
    td = np.geomspace(1, 1e9, 20)
    assert np.array_equal(sungaze.steady(td, law=law), sungaze.unbleached(td, np.inf, law=law)) or (
        abs(sungaze.steady(td, law=law) - sungaze.unbleached(td, np.inf, law=law)).max() < 1e-15
    )


def test_one_minus_the_steady_state_is_the_papers_equation():
    td = np.geomspace(1, 1e9, 50)
    paper = td / (td + 10**4.3)
    np.testing.assert_allclose(1 - sungaze.steady(td), paper, atol=2e-16)


@pytest.mark.parametrize("arguments, words", [
    (dict(trolands=[1, -1], seconds=1), r"trolands: found -1 at index \[1\]; accepted: finite"),
    (dict(trolands=np.nan, seconds=1), "trolands: found NaN; accepted: finite light, 0 or more"),
    (dict(trolands=1, seconds=-2), "seconds: found -2; accepted: seconds, 0 or more"),
    (dict(trolands=1, seconds=1, start=1.5), "start: found 1.5; accepted: fractions from 0 to 1"),
    (dict(trolands=1, seconds=1, tau_s=0), "tau_s: found 0; accepted: finite seconds above 0"),
    (dict(trolands=1, seconds=1, law="linear"), 'law: found "linear"; accepted: first-order, self'),
    (dict(trolands=np.ones(3), seconds=np.ones(2)), "shape mismatch"),
    (dict(trolands="much", seconds=1), "could not convert string to float"),
    (dict(trolands=1, seconds=1, law="rate-limited", km=0), "km: found 0; accepted: a finite"),
])
def test_what_is_wrong_is_said(arguments, words):
    with pytest.raises(ValueError, match=words):
        sungaze.unbleached(**arguments)
