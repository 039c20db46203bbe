"""A render of Mitsuba 3 stared at: a lamp over a table, then the same room with the lamp off."""

import mitsuba as mi
import numpy as np
import sungaze

from figure import plt, save

mi.set_variant("scalar_rgb")


def room(lamp):
    """Linear RGB, (h, w, 3), of a ball under a ball that shines with `lamp`."""
    at = mi.ScalarTransform4f
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 4},
        "sensor": {
            "type": "perspective", "fov": 40,
            "to_world": at().look_at(origin=[0, 1.5, 6], target=[0, 1, 0], up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": 192, "height": 144, "pixel_format": "rgb",
                     "component_format": "float32"},
            "sampler": {"type": "independent", "sample_count": 32},
        },
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [0.10, 0.12, 0.15]}},
        "floor": {"type": "rectangle", "to_world": at().rotate([1, 0, 0], -90).scale(5),
                  "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.6, 0.5, 0.4]}}},
        "ball": {"type": "sphere", "center": [-1, 0.6, 0], "radius": 0.6,
                 "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.2, 0.5, 0.6]}}},
        "lamp": {"type": "sphere", "center": [0.5, 1.9, 0], "radius": 0.3},
    }
    if lamp:
        scene["lamp"]["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": lamp}}
    return mi.render(mi.load_dict(scene))


on, off = room([120.0, 100.0, 70.0]), room(None)
# (1, 1, 1) is taken as 1000 cd/m2: a lamp of 1e5 cd/m2.
eye = sungaze.Eye(width=192, height=144, horizontal_fov_deg=40, white_cd_m2=1000)
looks = [("first moment", eye.look(on, 0.02, (0.57, 0.31))), ("after 30 s", eye.look(on, 30.0, (0.57, 0.31))),
         ("lamp off", eye.look(off, 1.0, (0.57, 0.31))), ("gaze moved, 2 s", eye.look(off, 1.0, (0.40, 0.55)))]

figure, panels = plt.subplots(1, 4, figsize=(12, 2.8))
for panel, (title, look) in zip(panels, looks):
    panel.imshow(look.display)
    panel.set(title=title, xticks=[], yticks=[])
    panel.grid(False)
save(figure, "mitsuba_render")
assert np.isfinite(looks[-1][1].percept).all()
