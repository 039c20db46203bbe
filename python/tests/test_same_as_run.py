"""A look equals what a run of the same frames writes: to the last bit for RGB."""

import exr
import numpy as np
import pytest
import sungaze

DURATIONS = [0.1, 3.0, 20.0, 0.5]
WANDERING = [(0.5, 0.5), (0.5, 0.5), (0.61, 0.44), (0.2, 0.9)]
STILL = [(0.5, 0.5)] * 4
LAWS = ["first-order", "self-screened", "rate-limited"]
SETS = ["cie2006", "smj1993"]


def run(folder, frames, config, gazes, names="RGB", white=5000.0):
    """What a run of these frames leaves, and the frames as it has read them."""
    for i, frame in enumerate(frames, 1):
        exr.write(folder / f"in.{i}.exr", frame, names)
    times = np.concatenate([[0.0], np.cumsum(DURATIONS)]).tolist()
    # The gaze rests from just after a frame's start to its end.
    spans = [t for start, end in zip(times, times[1:]) for t in (start + 1e-3, end)]
    rows = [f"{t!r},{x!r},{y!r}\n" for t, (x, y) in zip(spans, np.repeat(gazes, 2, 0).tolist())]
    (folder / "gaze.csv").write_text("time_s,x,y\n" + "".join(rows))
    keys = {
        **config,
        "input": {"frames": str(folder / "in.#.exr"), "horizontal_fov_deg": 12,
                  "white_cd_m2": white},
        "time": {"times_s": times},
        "gaze": {**config.get("gaze", {}), "path": str(folder / "gaze.csv")},
    }
    sungaze.run(keys, out=folder / "out")
    return folder / "out"


def assert_same(eye, frames, gazes, out):
    starts = np.concatenate([[0], np.cumsum(DURATIONS)])
    for i, frame in enumerate(frames):
        look = eye.look(frame, starts[i + 1] - starts[i], gazes[i])
        seen, header = sungaze.read(out / f"seen.{i + 1:04}.exr")
        assert np.array_equal(look.percept, seen.astype(np.float32)), f"frame {i + 1}"
        shown = display(out / f"display.{i + 1:04}.png")
        assert np.array_equal(look.display, shown), f"display {i + 1}"


def display(path):
    image = pytest.importorskip("PIL.Image")
    return np.asarray(image.open(path).convert("RGB"))


def frames_of(sun, dtype):
    return [(sun * share).astype(dtype) for share in (1.0, 0.7, 1.3, 0.01)]


@pytest.mark.parametrize("gazes", [STILL, WANDERING], ids=["still", "wandering"])
@pytest.mark.parametrize("dtype", [np.float16, np.float32])
@pytest.mark.parametrize("law", LAWS)
def test_rgb_frames(tmp_path, sun, dtype, law, gazes):
    config = {"observer": {"kinetics": law}}
    frames = frames_of(sun, dtype)
    out = run(tmp_path, frames, config, gazes)
    eye = sungaze.Eye(config, width=50, height=36, horizontal_fov_deg=12, white_cd_m2=5000)
    assert_same(eye, frames, gazes, out)


@pytest.mark.parametrize("keys", [
    {"observer": {"preset": "paper"}},
    {"numerics": {"model": "tracked"}},
    {"observer": {"fundamentals": "smj1993", "start": "adapted"}},
    {"observer": {"pupil_closing_s": 0.5, "pupil_opening_s": 2}, "display": {"smoothing_s": 0}},
], ids=["paper", "tracked", "adapted", "slow pupil"])
def test_other_observers(tmp_path, sun, keys):
    frames = frames_of(sun, np.float32)
    out = run(tmp_path, frames, keys, WANDERING)
    eye = sungaze.Eye(keys, width=50, height=36, horizontal_fov_deg=12, white_cd_m2=5000)
    assert_same(eye, frames, WANDERING, out)


@pytest.mark.parametrize("gazes", [STILL, WANDERING], ids=["still", "wandering"])
def test_bands(tmp_path, sun, gazes):
    bands = np.arange(400, 701, 20)
    spectra = np.exp(-(((bands - 560) / 90.0) ** 2)) * sun.mean(axis=2, keepdims=True) * 5
    frames = frames_of(spectra, np.float32)
    names = [f"S0.{nm},000000nm" for nm in bands]
    out = run(tmp_path, frames, {}, gazes, names, white=None)
    read, header = sungaze.read(tmp_path / "in.1.exr")
    assert np.array_equal(read, frames[0])
    eye = sungaze.Eye(width=50, height=36, horizontal_fov_deg=12, bands_nm=header["bands_nm"])
    assert_same(eye, frames, gazes, out)


def test_state_and_restore_go_on_to_the_same_bits(eye, sun):
    eye.look(sun, 3.0)
    state = eye.state()
    there = eye.look(sun * 0.1, 1.0, (0.6, 0.4))
    eye.look(sun, 100.0)
    eye.restore(state)
    back = eye.look(sun * 0.1, 1.0, (0.6, 0.4))
    assert np.array_equal(there.percept, back.percept)
    assert np.array_equal(there.display, back.display)


def test_reset_begins_anew(eye, sun):
    first = eye.look(sun, 3.0).percept
    assert not np.array_equal(eye.look(sun, 3.0).percept, first)
    eye.reset()
    assert (eye.unbleached == 1).all()
    assert np.array_equal(eye.look(sun, 3.0).percept, first)
