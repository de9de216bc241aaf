"""The brake, where 1.0.0 had it; its home is :mod:`squealpipe.brake.a1.motion_system`."""

from importlib import import_module
from typing import Any


def __getattr__(name: str) -> Any:
    # imported by name: systems stand alone, and the room of the brake is above them
    return getattr(import_module("squealpipe.brake.a1.motion_system"), name)
