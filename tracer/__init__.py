"""Shadow culling for interactive ray tracing, after Nah, Lee, Park and Han: the tracer, of use alone.

scene = tracer.load_scene("kitchen.aff")
renderer = tracer.Renderer(scene, tracer.Settings(width=512, height=512, method="paper"))
frame = renderer.render(time=5.0)
frame.statistics.shadow.traversal_steps
"""

from tracer import experiment
from tracer.frame import Frame, Settings
from tracer.geometry.rays import ray_batch as RayBatch
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.load import load_scene, scene_info
from tracer.scene.model import Camera, Cancelled, Scene, SceneError

__all__ = [
    "Camera",
    "Cancelled",
    "Frame",
    "RayBatch",
    "Renderer",
    "Scene",
    "SceneError",
    "Settings",
    "World",
    "experiment",
    "load_scene",
    "scene_info",
]
