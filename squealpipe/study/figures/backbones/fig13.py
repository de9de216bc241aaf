"""Fig. 13: backbones of both modes at (5π/6, 5π/6)."""

from squealpipe.study.figures.parts.backbone_panels import SCENE_ALT, draw_scene, scene_caption

READS = ("backbone/F13_*",)
CAPTION, ALT, draw = scene_caption, SCENE_ALT, draw_scene
