"""Every example runs, and draws the figure that lies beside it."""

import runpy
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"
NEEDS = {"spectrum": "colour", "sweep_in_pandas": "pandas", "mitsuba_render": "mitsuba",
         "after_image": "PIL"}
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.py") if path.stem != "figure")


@pytest.mark.parametrize("name", NAMES)
def test_example(name, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    monkeypatch.syspath_prepend(str(EXAMPLES))
    import figure

    monkeypatch.setattr(figure, "HERE", tmp_path)
    runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
    drawn = figure.plt.imread(tmp_path / f"{name}.png")
    kept = figure.plt.imread(EXAMPLES / f"{name}.png")
    # Fonts and renders differ a little from one version to another; what is drawn does not.
    assert drawn.shape == kept.shape
    assert abs(drawn - kept).mean() < 0.02


def test_every_figure_has_its_example():
    assert {path.stem for path in EXAMPLES.glob("*.png")} == set(NAMES)
