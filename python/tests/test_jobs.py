"""Runs, sweeps and files; processes; what is written about it all."""

import doctest
import json
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import sungaze

SHORT = {"input": {"width": 32}, "time": {"times_s": [0, 0.5, 1.0, 2.0]}, "output": {"page": False}}


def test_run_returns_its_report_and_tells_its_progress(tmp_path):
    told = []
    report = sungaze.run(SHORT, out=tmp_path / "out", progress=lambda *at: told.append(at))
    assert told[-1] == (report["frames"]["count"],) * 2
    assert len(told) == report["frames"]["count"]
    assert (tmp_path / "out" / "seen.0001.exr").exists()


def test_what_progress_raises_ends_the_run_which_goes_on_later(tmp_path):
    def stop(done, total):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        sungaze.run(SHORT, out=tmp_path / "out", progress=stop)
    with pytest.raises(ValueError, match="out"):
        sungaze.run(SHORT, out=tmp_path / "out")
    assert sungaze.run(SHORT, out=tmp_path / "out", resume=True)["frames"]["count"] >= 3


def test_an_interrupt_is_a_keyboard_interrupt(tmp_path):
    # Behind a shell's `&` Python ignores interrupts unless it is told to heed them.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    long = {**SHORT, "time": {"interval_s": 0.01, "duration_s": 1000.0}}

    def interrupt(done, total):
        if done == 3:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        sungaze.run(long, out=tmp_path / "out", progress=interrupt)


def test_sweep_gives_typed_columns(tmp_path):
    table = sungaze.sweep({
        "input": {"width": 16},
        "sweep": {
            "durations_s": [1, 60],
            "vary": [{"key": "observer.kinetics", "values": ["first-order", "rate-limited"]}],
        },
    })
    assert table["case"].dtype == np.int64 and table["case"].tolist() == [0, 0, 1, 1]
    assert table["observer.kinetics"][2] == "rate-limited"
    assert table["p_L"].dtype == np.float64 and (table["p_L"][::2] > table["p_L"][1::2]).all()


def test_words_of_a_sweep_stand_plain_in_every_table(tmp_path):
    table = sungaze.sweep({
        "input": {"width": 32},
        "output": {"law": True},
        "sweep": {
            "durations_s": [1],
            "vary": [
                {"key": "observer.kinetics", "values": ["first-order", "rate-limited"]},
                {"key": "gaze.at", "values": ["brightest", [0.2, 0.3]]},
            ],
        },
    }, out=tmp_path / "out")
    names = ("observer.kinetics", "gaze.at")
    rows = list(zip(*(table[name].tolist() for name in names)))
    assert rows[:2] == [("first-order", "brightest"), ("first-order", "[0.2, 0.3]")]
    typed = json.loads((tmp_path / "out" / "sweep.json").read_text())
    assert [row["observer.kinetics"] for row in typed] == [row[0] for row in rows]
    assert [row["gaze.at"] for row in typed][:2] == ["brightest", [0.2, 0.3]]
    assert table["p_L"].tolist() == [row["p_L"] for row in typed]
    lines = (tmp_path / "out" / "sweep.csv").read_text().splitlines()
    assert lines[2].startswith("0,1,first-order,brightest,gaze,")
    assert lines[3].startswith('1,1,first-order,"[0.2, 0.3]",gaze,')


def test_a_sweep_without_a_table_is_refused():
    with pytest.raises(ValueError, match="sweep"):
        sungaze.sweep({})


@pytest.mark.parametrize("name", ["missing.exr", "missing.png", "missing.hdr"])
def test_a_missing_file_is_not_found(name):
    with pytest.raises(FileNotFoundError, match=name):
        sungaze.read(name)


def test_files_that_are_no_frames_are_os_errors(tmp_path):
    for name, content in [("a.exr", b"no picture"), ("a.txt", b""), ("a.png", bytes(9))]:
        (tmp_path / name).write_bytes(content)
        with pytest.raises(OSError, match=name):
            sungaze.read(tmp_path / name)


def child(code):
    """Runs Python in a process of its own."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)


FORK = """
import os, sys, numpy as np, sungaze
keys = {{"optics": {{"psf": "cie" if {optics} else "none"}}}}
eye = sungaze.Eye(keys, width=40, height=30, horizontal_fov_deg=9, white_cd_m2=100)
frame = np.ones((30, 40, 3), np.float32)
before = {used}
if before: eye.look(frame, 1.0)
child = os.fork()
if child == 0:
    try: eye.look(frame, 1.0)
    except RuntimeError as error: print(error, flush=True); os._exit(7)
    os._exit(0)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


def test_a_fork_after_use_is_refused_and_one_before_is_right():
    for used, optics in [(True, False), (False, True)]:
        after = child(FORK.format(used=used, optics=optics))
        assert after.returncode == 7 and "spawn" in after.stdout, after
    assert child(FORK.format(used=False, optics=False)).returncode == 0


def test_threads_are_set_before_the_first_look_and_change_no_bit():
    code = """
import hashlib, numpy as np, sungaze
sungaze.set_threads({n})
frame = np.linspace(0, 5000, 90 * 120 * 3, dtype=np.float32).reshape(90, 120, 3)
eye = sungaze.Eye(width=120, height=90, horizontal_fov_deg=9, white_cd_m2=1000)
looks = [eye.look(frame, 1.0, at) for at in [(.5, .5), (.6, .5)]]
print(hashlib.sha256(b"".join(look.percept.tobytes() for look in looks)).hexdigest())
try: sungaze.set_threads(2)
except ValueError as error: print(error)
"""
    one, three = child(code.format(n=1)), child(code.format(n=3))
    assert one.stdout == three.stdout
    assert "before the first look" in one.stdout, one
    with pytest.raises(ValueError, match="count: found 0; accepted: 1 or more"):
        sungaze.set_threads(0)


def test_pythons_lock_is_let_go_of_during_a_look(eye, sun):
    """Another thread of Python counts while this one looks for long."""
    big = np.broadcast_to(sun[:1, :1], (1500, 1500, 3)).copy()
    wide = sungaze.Eye(width=1500, height=1500, horizontal_fov_deg=40, white_cd_m2=1e4)
    counted, looking = [], threading.Event()

    def count():
        looking.wait()
        while looking.is_set():
            counted.append(time.perf_counter())
            time.sleep(0.0005)

    counter = threading.Thread(target=count)
    counter.start()
    looking.set()
    begun = time.perf_counter()
    wide.look(big, 10.0)
    ended = time.perf_counter()
    looking.clear()
    counter.join()
    assert sum(begun < at < ended for at in counted) > 2


def documented():
    for name in sungaze.__all__:
        thing = getattr(sungaze, name)
        yield name, thing
        if isinstance(thing, type):
            for member in vars(thing):
                if not member.startswith("_"):
                    yield f"{name}.{member}", getattr(thing, member)


@pytest.mark.parametrize("name, thing", list(documented()))
def test_examples_in_the_documentation_are_true(name, thing):
    assert thing.__doc__, f"{name} is not documented"
    examples = doctest.DocTestParser().get_doctest(thing.__doc__, {}, name, None, None)
    # colour-science, imported by an example, sets how NumPy prints for the whole process.
    with np.printoptions(legacy=False):
        assert doctest.DocTestRunner().run(examples).failed == 0
