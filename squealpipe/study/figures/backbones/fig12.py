"""Fig. 12: backbones of both modes at (3π/4, 3π/4)."""

from squealpipe.study.figures.parts.backbone_panels import SCENE_ALT, draw_scene, scene_caption

READS = ("backbone/F12_*",)
CAPTION, ALT, draw = scene_caption, SCENE_ALT, draw_scene
