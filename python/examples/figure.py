"""What the figures share: their look, and where they go."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

HERE = Path(__file__).parent
# Okabe & Ito 2008: told apart by colour-blind eyes. L, M and S.
CONES = {"L": "#D55E00", "M": "#009E73", "S": "#0072B2"}

plt.rcParams.update({
    "figure.dpi": 110, "font.size": 11, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.alpha": 0.25, "legend.frameon": False, "figure.constrained_layout.use": True,
})


def save(figure, name):
    path = HERE / f"{name}.png"
    # No date and no version, so that the same figure is the same file.
    figure.savefig(path, metadata={"Software": None})
    plt.close(figure)
    return path
