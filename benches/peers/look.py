"""One look at a 1080p float RGB frame, tracked: processor time from Python, Rust, NumPy and JAX, in turns.

    cargo bench --bench look --no-run        # prints where the executable is
    python look.py EXECUTABLE [ROUNDS]       # a Python with sungaze and numpy; jax is left out where missing

NumPy and JAX compute what is computed at every place: illuminance, the exact step, the catch through
pigment of four densities, the percept. Sungaze also surveys the frame, moves the pupil and checks the
samples.
"""

import resource
import statistics
import subprocess
import sys

import numpy as np
import sungaze

HEIGHT, WIDTH, DT = 1080, 1920, 1 / 24
TAU, HALF_BLEACH = 120.0, np.float64([10**4.3, 10**4.3, 10**5])
y, x, i = np.ogrid[:HEIGHT, :WIDTH, :3]
FRAME = ((0.1 + (x % 251) * 0.004 + (y % 127) * 0.002) * (1 + i * 0.1)).astype(np.float32)
RNG = np.random.default_rng(0)
# RGB -> trolands of L, M and S; RGB -> catches at four levels of pigment; catches -> RGB. The numbers do
# not matter to the time.
TO_TD = RNG.uniform(1e4, 3e4, (3, 3)).astype(np.float32)
TO_LMS = RNG.uniform(0.2, 1, (4, 3, 3)).astype(np.float32)
TO_RGB = np.linalg.inv(TO_LMS[0]).astype(np.float32)
LEVELS = np.float32([1.0, 0.7, 0.35, 0.0])


def lagrange(np, p):
    """The weights of four levels at p: (..., 4)."""
    terms = []
    for k in range(4):
        others = [j for j in range(4) if j != k]
        terms.append(np.prod(np.stack([(p - LEVELS[j]) / (LEVELS[k] - LEVELS[j]) for j in others]), 0))
    return np.stack(terms, -1)


def by_hand(np, frame, p):
    """The next p and the percept, as one would write it on arrays."""
    td = frame @ TO_TD.T
    a = 1 + td / HALF_BLEACH
    p = 1 / a + np.exp(-DT / TAU * a) * (p - 1 / a)
    lms = np.einsum("hwi,nki,hwkn->hwk", frame, TO_LMS, lagrange(np, p.astype(np.float32)), optimize=True)
    return p, lms @ TO_RGB.T


def python():
    keys = {"numerics": {"model": "tracked"}}
    eye = sungaze.Eye(keys, width=WIDTH, height=HEIGHT, horizontal_fov_deg=40, white_cd_m2=20_000)
    return lambda: eye.look(FRAME, DT)


def numpy():
    state = [np.ones((HEIGHT, WIDTH, 3))]

    def look():
        state[0], percept = by_hand(np, FRAME, state[0])
        return percept

    return look


def jax():
    import jax as j
    import jax.numpy as jnp

    j.config.update("jax_enable_x64", True)
    step = j.jit(lambda frame, p: by_hand(jnp, frame, p))
    state = [jnp.ones((HEIGHT, WIDTH, 3))]

    def look():
        state[0], percept = step(jnp.asarray(FRAME), state[0])
        return percept.block_until_ready()

    return look


def spent(who):
    usage = resource.getrusage(who)
    return (usage.ru_utime + usage.ru_stime) * 1e3


def timed(look, count):
    """Processor time of one look, ms."""
    begun = spent(resource.RUSAGE_SELF)
    for _ in range(count):
        look()
    return (spent(resource.RUSAGE_SELF) - begun) / count


def rust(executable, count):
    """The same of the executable: what more looks take than fewer."""

    def run(looks):
        begun = spent(resource.RUSAGE_CHILDREN)
        subprocess.run([executable, str(looks)], check=True, stdout=subprocess.DEVNULL)
        return spent(resource.RUSAGE_CHILDREN) - begun

    few = run(5)
    return (run(5 + count) - few) / count


def main():
    executable, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 5
    looks = {"sungaze, Python": (python(), 20), "NumPy by hand": (numpy(), 2)}
    try:
        looks["JAX by hand"] = (jax(), 4)
    except ImportError:
        print("jax is not installed", file=sys.stderr)
    for look, _ in looks.values():
        look()
    found = {name: [] for name in [*looks, "sungaze, Rust"]}
    for _ in range(rounds):
        for name, (look, count) in looks.items():
            found[name].append(timed(look, count))
        found["sungaze, Rust"].append(rust(executable, 20))
    reference = statistics.median(found["sungaze, Python"])
    print("peer,processor_ms,least_ms,over_python")
    for name, times in found.items():
        median = statistics.median(times)
        print(f'"{name}",{median:.1f},{min(times):.1f},{median / reference:.2f}')


main()
