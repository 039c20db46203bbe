"""What a person sees while staring at a bright light, on NumPy arrays.

Frames go in, spectral or RGB, scene-linear, in absolute units; photopigment bleaches and regenerates
at every place of the retina; out comes what this tired eye perceives. See :class:`Eye` for frames in
memory, :func:`unbleached` for the law itself, :func:`run` and :func:`sweep` for whole jobs.

Looks share one pool of threads (:func:`set_threads`) and let go of Python's lock. After a `fork` the
pool is not there and a look raises `RuntimeError`: start processes with `spawn`.
"""

from ._sungaze import Eye, Look, read, run, set_threads, steady, sweep, unbleached

__all__ = ["Eye", "Look", "read", "run", "set_threads", "steady", "sweep", "unbleached"]
