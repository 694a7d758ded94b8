"""Shadow culling for interactive ray tracing: a tracer that needs no window.

It implements the algorithm of this paper, whose sections are cited as §:

    Nah, Lee, Park and Han: A Shadow Culling Algorithm for Interactive Ray Tracing.
    (Listed as: Jae-Ho Nah, Woo-Chan Park, Tack-Don Han, Journal of Korea Game Society, December 2009.)

Render a frame and read a counter:

scene = tracer.load_scene("kitchen.aff")
renderer = tracer.Renderer(scene, tracer.Settings(width=512, height=512, method="paper"))
frame = renderer.render(time=5.0)
frame.statistics.shadow.traversal_steps
"""

import sys

from tracer.runtime import prebuilt

prebuilt.use()  # before anything imports numba

from tracer.experiments import experiment, lamp_experiment, zoom
from tracer.frame import Frame, Settings
from tracer.geometry.rays import ray_batch as RayBatch
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.load import load_scene, scene_info
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Camera, Cancelled, Scene, SceneError

__all__ = [
    "Camera",
    "Cancelled",
    "Frame",
    "MeshOptions",
    "RayBatch",
    "Renderer",
    "Scene",
    "SceneError",
    "Settings",
    "World",
    "experiment",
    "lamp_experiment",
    "load_scene",
    "scene_info",
    "zoom",
]

# Scripts import from these under their shorter names, too.
sys.modules["tracer.experiment"] = experiment
sys.modules["tracer.lamp_experiment"] = lamp_experiment
sys.modules["tracer.zoom"] = zoom
