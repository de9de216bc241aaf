"""Fig. 10: backbones of both modes at (π/2, π)."""

from squealpipe.study.figures.parts.backbone_panels import SCENE_ALT, draw_scene, scene_caption

READS = ("backbone/F10_*",)
CAPTION, ALT, draw = scene_caption, SCENE_ALT, draw_scene
