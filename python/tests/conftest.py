"""What the tests share: the project's folder, and one small scene."""

from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def in_project(monkeypatch):
    monkeypatch.chdir(ROOT)


@pytest.fixture
def sun():
    """RGB, (36, 50, 3): a disc of some 2e7 cd/m2 in a sky, where white is 5000 cd/m2."""
    y, x = np.mgrid[:36, :50]
    sky = np.stack([0.1 + 0.01 * x, 0.2 + 0.01 * y, np.full_like(x, 0.5, float)], axis=-1)
    disc = np.hypot(x - 25, y - 18) < 6
    return np.where(disc[..., None], [4000.0, 3600.0, 2500.0], sky).astype(np.float32)


@pytest.fixture
def eye():
    """An eye for that scene."""
    import sungaze

    return sungaze.Eye(width=50, height=36, horizontal_fov_deg=12, white_cd_m2=5000)
