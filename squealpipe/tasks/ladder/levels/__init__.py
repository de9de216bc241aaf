"""How each level of the model ladder answers over a map; a module each.

The module of a level has the level's name in :class:`squealpipe.schema.ladder.Level` and a function
``answer(scenes) -> Answers``. Levels that integrate a model in time share ``in_time``.
"""

from __future__ import annotations

from importlib import import_module

from squealpipe.schema.ladder import Level
from squealpipe.tasks.ladder.levels import in_time
from squealpipe.tasks.ladder.levels.answers import Answers, Scenes


def answer(level: Level, scenes: Scenes) -> Answers:
    """The answers of one level.

    Raises:
        ModuleNotFoundError: a level without a model has no module.
    """
    if level.model:
        return in_time.answer(level, scenes)
    found: Answers = import_module(f"{__name__}.{level.name}").answer(scenes)
    return found
