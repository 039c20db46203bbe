from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Config = str | PathLike[str] | Mapping[str, Any]
_Law = Literal["first-order", "self-screened", "rate-limited"]

__all__ = ["Eye", "Look", "read", "run", "set_threads", "steady", "sweep", "unbleached"]

@final
class Eye:
    def __new__(
        cls,
        config: _Config | None = None,
        *,
        width: int,
        height: int,
        horizontal_fov_deg: float | None = None,
        white_cd_m2: float | None = None,
        bands_nm: ArrayLike | None = None,
    ) -> Eye: ...
    def look(
        self,
        frame: ArrayLike,
        dt: float,
        gaze: tuple[float, float] | None = None,
        out: NDArray[np.float32] | None = None,
    ) -> Look: ...
    @property
    def unbleached(self) -> NDArray[np.float64]: ...
    def state(self) -> bytes: ...
    def restore(self, state: bytes) -> None: ...
    def reset(self) -> None: ...

@final
class Look:
    @property
    def percept(self) -> NDArray[np.float32]: ...
    @property
    def display(self) -> NDArray[np.uint8]: ...
    @property
    def trolands(self) -> NDArray[np.float32]: ...
    @property
    def pupil_mm(self) -> float: ...
    @property
    def adapting_cd_m2(self) -> float: ...

def unbleached(
    trolands: ArrayLike,
    seconds: ArrayLike,
    start: ArrayLike = 1.0,
    half_bleach_log_td: ArrayLike = 4.3,
    tau_s: ArrayLike = 120.0,
    law: _Law = "first-order",
    *,
    optical_density: float = 0.5,
    km: float = 0.2,
) -> Any: ...
def steady(
    trolands: ArrayLike,
    half_bleach_log_td: ArrayLike = 4.3,
    law: _Law = "first-order",
    *,
    optical_density: float = 0.5,
    km: float = 0.2,
) -> Any: ...
def run(
    config: _Config | None = None,
    out: str | PathLike[str] | None = None,
    progress: Callable[[int, int], object] | None = None,
    *,
    resume: bool = False,
    overwrite: bool = False,
) -> dict[str, Any]: ...
def sweep(
    config: _Config,
    out: str | PathLike[str] | None = None,
    progress: Callable[[int, int], object] | None = None,
    *,
    resume: bool = False,
    overwrite: bool = False,
) -> dict[str, NDArray[Any]]: ...
def read(
    path: str | PathLike[str], config: _Config | None = None
) -> tuple[NDArray[Any], dict[str, Any]]: ...
def set_threads(count: int) -> None: ...
