"""Fig. 11: backbones of both modes at (π, π/2)."""

from squealpipe.study.figures.parts.backbone_panels import SCENE_ALT, draw_scene, scene_caption

READS = ("backbone/F11_*",)
CAPTION, ALT, draw = scene_caption, SCENE_ALT, draw_scene
