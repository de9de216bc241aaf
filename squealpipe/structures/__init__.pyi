from .contact import Contact
from .meshes.faces import Face, Rotation
from .shipped_disc import disc_brake
from .shipped_pad import elastic_pad
from .structure import Structure

__all__ = ["Contact", "Face", "Rotation", "Structure", "disc_brake", "elastic_pad"]
