"""A bright cross, stared at for twenty seconds; then its after-image on a grey wall, fading."""

import numpy as np
import sungaze
from PIL import Image

from figure import HERE, plt, save

HEIGHT, WIDTH = 180, 240
y, x = np.mgrid[:HEIGHT, :WIDTH]
cross = (abs(x - WIDTH / 2) < 12) & (abs(y - HEIGHT / 2) < 60)
cross |= (abs(y - HEIGHT / 2) < 12) & (abs(x - WIDTH / 2) < 60)
wall = np.full((HEIGHT, WIDTH, 3), 0.5, np.float32)
lamp = np.where(cross[..., None], np.float32([60.0, 24.0, 6.0]), 0.1 * wall).astype(np.float32)

# Without the tone map's own adaptation, which would follow the lamp: a fixed exposure.
keys = {"display": {"tone": "exposure", "exposure_ev": -4.5}}
eye = sungaze.Eye(keys, width=WIDTH, height=HEIGHT, horizontal_fov_deg=12, white_cd_m2=3000)
eye.look(lamp, 20.0)
seconds = np.arange(0.5, 60.5, 0.5)
shown = [eye.look(wall, 0.5).display for _ in seconds]

pictures = [Image.fromarray(picture) for picture in shown[::4]]
pictures[0].save(HERE / "after_image.gif", save_all=True, append_images=pictures[1:], duration=120, loop=0)

figure, axes = plt.subplots(1, 4, figsize=(12, 2.8))
for panel, at in zip(axes, [0, 19, 49, 119]):
    panel.imshow(shown[at])
    panel.set(title=f"{seconds[at]:g} s on the wall", xticks=[], yticks=[])
    panel.grid(False)
save(figure, "after_image")
