"""Arrays in and out: any layout, no copy where none is needed, and words for what is refused."""

import threading

import numpy as np
import pytest
import sungaze

PLAIN = dict(width=50, height=36, horizontal_fov_deg=12, white_cd_m2=5000)


class Wrapped:
    def __init__(self, array):
        self.array = array

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.array, dtype)


def unaligned(array):
    packed = np.zeros(array.shape, np.dtype([("pad", "u1"), ("v", array.dtype)], align=False))
    packed["v"] = array
    return packed["v"]


@pytest.mark.parametrize("laid_out", [
    np.asfortranarray,
    lambda a: np.ascontiguousarray(a.transpose(0, 2, 1)).transpose(0, 2, 1),
    lambda a: np.repeat(np.repeat(a, 2, 0), 3, 1)[::2, ::3],
    lambda a: np.ascontiguousarray(a[::-1, ::-1])[::-1, ::-1],
    lambda a: a.astype(">f4"),
    lambda a: a.astype(np.float64),
    unaligned,
    Wrapped,
    lambda a: a.tolist(),
], ids=["F", "planes", "strided", "reversed", "big-endian", "double", "unaligned", "__array__", "list"])
def test_every_layout_is_seen_alike(eye, sun, laid_out):
    expected = eye.look(sun, 5.0).percept
    eye.reset()
    assert np.array_equal(eye.look(laid_out(sun), 5.0).percept, expected)


def test_an_unbleached_eye_returns_its_input(sun):
    eye = sungaze.Eye({"numerics": {"model": "none"}}, **PLAIN)
    for frame in (sun, sun.astype(np.float16)):
        assert np.array_equal(eye.look(frame, 10.0).percept, frame)


def test_the_percept_is_the_looks_own_memory_and_read_only(eye, sun):
    look = eye.look(sun, 1.0)
    assert look.percept is look.percept
    assert not look.percept.flags.writeable
    kept = look.percept.copy()
    eye.look(sun * 2, 50.0)
    assert np.array_equal(look.percept, kept)


def test_out_is_written_too_in_any_strides(eye, sun):
    out = np.zeros((36, 100, 3), np.float32)
    look = eye.look(sun, 5.0, out=out[:, ::2])
    assert np.array_equal(out[:, ::2], look.percept)
    assert (out[:, 1::2] == 0).all()


def test_a_frame_may_be_written_over(eye, sun):
    expected = eye.look(sun, 5.0).percept
    eye.reset()
    eye.look(sun, 5.0, out=sun)
    assert np.array_equal(sun, expected)


def test_trolands_move_the_pigment_as_the_law_says(sun):
    keys = {"numerics": {"model": "tracked"}}
    eye = sungaze.Eye(keys, **PLAIN)
    look = eye.look(sun, 20.0)
    expected = sungaze.unbleached(look.trolands, 20.0, half_bleach_log_td=[4.3, 4.3, 5.0])
    np.testing.assert_allclose(eye.unbleached, expected, atol=2e-15)


def test_trolands_are_of_the_latest_look_only(eye, sun):
    early, kept = eye.look(sun, 1.0), eye.look(sun, 1.0)
    trolands = kept.trolands
    eye.look(sun, 1.0)
    assert kept.trolands is trolands
    with pytest.raises(ValueError, match="trolands: found a look before the latest"):
        early.trolands


def test_unbleached_follows_the_light(eye, sun):
    assert eye.unbleached.shape == (36, 50, 3)
    eye.look(sun, 60.0)
    assert eye.unbleached[18, 25].max() < 0.1 < 0.9 < eye.unbleached[0, 0].min()


@pytest.mark.parametrize("frame, words", [
    (np.zeros((36, 50), np.float32), "frame: found float32 of 2 dimensions; accepted: float16"),
    (np.zeros((36, 50, 3), np.uint8), "frame: found uint8 of 3 dimensions; accepted: float16, fl"),
    (np.zeros((36, 50, 3), complex), "frame: found complex128"),
    (np.zeros((50, 36, 3), np.float32), r"accepted: \(height, width, planes\) = \(36, 50, 3\)"),
    (np.zeros((36, 50, 4), np.float32), r"accepted: \(height, width, planes\) = \(36, 50, 3\)"),
    (np.zeros((0, 0, 3), np.float32), r"accepted: \(height, width, planes\) = \(36, 50, 3\)"),
    ("a picture", "frame: found <U9 of 0 dimensions"),
    (None, "frame: found object of 0 dimensions"),
])
def test_frames_that_are_none_are_refused(eye, frame, words):
    with pytest.raises(ValueError, match=words):
        eye.look(frame, 1.0)
    assert (eye.unbleached == 1).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_sample_that_is_not_finite_is_named(eye, sun, bad):
    sun[7, 9, 1] = bad
    with pytest.raises(ValueError, match="plane 1 is not finite at column 9, row 7"):
        eye.look(sun, 1.0)


@pytest.mark.parametrize("arguments, error", [
    (dict(dt=-1.0), ValueError),
    (dict(dt=np.nan), ValueError),
    (dict(dt="1"), TypeError),
    (dict(dt=1.0, gaze=(0.5,)), ValueError),
    (dict(dt=1.0, gaze=(np.nan, 0.5)), ValueError),
    (dict(dt=1.0, gaze="brightest"), ValueError),
    (dict(dt=1.0, out=np.zeros((36, 50, 3))), ValueError),
    (dict(dt=1.0, out=np.zeros((50, 36, 3), np.float32)), ValueError),
    (dict(dt=1.0, out=np.broadcast_to(np.float32(0), (36, 50, 3))), ValueError),
    (dict(dt=1.0, out=unaligned(np.zeros((36, 50, 3), np.float32))), ValueError),
    (dict(dt=1.0, out=[]), ValueError),
])
def test_other_arguments_are_refused(eye, sun, arguments, error):
    with pytest.raises(error):
        eye.look(sun, **arguments)
    assert (eye.unbleached == 1).all()


def test_out_without_leave_to_write_says_what_is_accepted(eye, sun):
    with pytest.raises(ValueError, match=r"out: .*accepted: a writable float32 array of shape"):
        eye.look(sun, 1.0, out=np.zeros(3))


@pytest.mark.parametrize("keys, arguments, words", [
    ({"observer": {"aeg": 3}}, {}, "config: observer.aeg: .*unknown field"),
    ({"observer": {"age": 300}}, {}, "config: observer.age: found 300; accepted: 20 to 80"),
    ({"observer": {"age": "old"}}, {}, "config: observer.age: .*accepted|config: observer.age: inv"),
    ({"observer": {"age": object()}}, {}, "config: observer: age: found .*; accepted: numbers"),
    ({3: 4}, {}, "config: found the key 3"),
    (17, {}, "config: found 17 .*; accepted: the path of a TOML file, a dict"),
    ("nowhere.toml", {}, "nowhere.toml: CONFIG: cannot read"),
    ({"gaze": {"at": "brightest"}}, {}, "gaze.at: has no meaning for frames in memory"),
    (None, dict(width=0), "width, height: found 0 x 36"),
    (None, dict(width=-5), "width, height: found -5 x 36"),
    (None, dict(width=2**40, height=2**40), "width, height: found"),
    (None, dict(horizontal_fov_deg=None), "horizontal_fov_deg: found none; accepted: how many"),
    (None, dict(horizontal_fov_deg=np.nan), "horizontal_fov_deg: found NaN"),
    (None, dict(white_cd_m2=None), "white_cd_m2: found none; accepted: the luminance of"),
    (None, dict(white_cd_m2=-1), "input.white_cd_m2: found -1"),
    (None, dict(bands_nm=[500, 600]), "bands_nm: found both"),
    (None, dict(white_cd_m2=None, bands_nm=[600, 500]), r"bands_nm: found \[600, 500\]"),
    (None, dict(white_cd_m2=None, bands_nm=3), "bands_nm: found 3 "),
    (None, dict(white_cd_m2=None, bands_nm=[]), r"bands_nm: found \[\]"),
])
def test_eyes_that_cannot_be_made(keys, arguments, words):
    with pytest.raises(ValueError, match=words):
        sungaze.Eye(keys, **{**PLAIN, **arguments})


@pytest.mark.parametrize("state", [b"", b"nonsense", b"\xff" * 200, bytes(1000)])
def test_a_state_that_is_none_leaves_the_eye_as_it_was(eye, sun, state):
    eye.look(sun, 5.0)
    before = eye.unbleached
    with pytest.raises(ValueError):
        eye.restore(state)
    assert np.array_equal(eye.unbleached, before)


def test_trolands_are_those_of_the_retina_where_the_eye_scatters(sun):
    keys = {"optics": {"psf": "cie"}, "numerics": {"model": "tracked"}}
    eye = sungaze.Eye(keys, **PLAIN)
    look = eye.look(sun, 0.001)
    clear = sungaze.Eye(**PLAIN).look(sun, 0.001)
    dark = clear.trolands[..., 0] < 0.01 * clear.trolands[..., 0].max()
    assert (look.trolands[dark] > 1.5 * clear.trolands[dark]).any()
    # So short a look bleaches in proportion to its trolands.
    moved = (1 - eye.unbleached) / np.maximum(look.trolands, 1)
    assert np.ptp(moved[..., 0]) < 0.05 * moved[..., 0].max()


def test_a_state_of_another_size_is_refused(eye, sun):
    for width in (20, 500):
        other = sungaze.Eye(**{**PLAIN, "width": width})
        with pytest.raises(ValueError, match="another size"):
            eye.restore(other.state())


def test_eyes_in_two_threads_see_what_they_see_alone(sun):
    def watch(scale, into):
        eye = sungaze.Eye(**PLAIN)
        for _ in range(20):
            into[scale] = eye.look(sun * scale, 0.5).percept

    alone, together = {}, {}
    for scale in (1.0, 2.0, 3.0):
        watch(scale, alone)
    threads = [threading.Thread(target=watch, args=(s, together)) for s in (1.0, 2.0, 3.0)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert all(np.array_equal(alone[scale], together[scale]) for scale in alone)


def test_one_eye_in_two_threads_loses_no_look(sun):
    def after(looks):
        eye = sungaze.Eye({"numerics": {"model": "tracked"}}, **PLAIN)
        return eye, [threading.Thread(target=eye.look, args=(sun, 0.5)) for _ in range(looks)]

    eye, threads = after(8)
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    alone, looks = after(8)
    [look.run() for look in looks]
    assert np.array_equal(eye.unbleached, alone.unbleached)
