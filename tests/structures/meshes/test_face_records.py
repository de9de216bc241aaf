"""What is said about a face and a rotation."""

import numpy as np
import pytest

from squealpipe.structures import Face, Rotation, Structure

WHOLE = {"surface": "PAD", "against": "DISC", "stiffness": 1e9, "pressure": 5e5}


def test_numbers_of_a_face_have_units():
    face = Face("PAD", against="DISC", stiffness="2.5e6 N/mm", pressure="0.5 MPa")
    assert (face.stiffness, face.pressure) == (2.5e9, 5e5)
    assert Face(
        "PAD", stiffness_per_area="3 N/mm^3", force="2 kN"
    ).stiffness_per_area == pytest.approx(3e9)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"surface": ""}, "name of a surface"),
        ({"against": "PAD"}, "cannot rub against itself"),
        ({"stiffness": None}, "stiffness is missing"),
        ({"stiffness_per_area": 1.0}, "both given"),
        ({"pressure": None}, "pressure is missing; give it, or force or pressures"),
        ({"force": 3.0}, "pressure and force are both given"),
        ({"pressure": 0.0}, "nothing presses"),
        ({"stiffness": -1.0}, "greater than 0"),
        ({"pressure": "5 N"}, "Pa|pressure"),
        ({"direction": [0, 0, 0]}, "points nowhere"),
        ({"direction": [1, 0]}, "three numbers"),
        ({"points": 0}, "whole number from 1"),
        ({"points": 2.5}, "whole number from 1"),
    ],
)
def test_wrong_face_is_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        Face(**{**WHOLE, **changes})


def test_velocity_of_a_rotation_is_that_of_its_circle():
    rotation = Rotation(axis=[0, 0, 2], through=[1, 0, 5], speed="60 rpm")
    assert rotation.speed == pytest.approx(2 * np.pi)
    np.testing.assert_allclose(
        rotation.velocity(np.array([[1, 3, 0], [2, 0, 1]])), [[-3, 0, 0], [0, 1, 0]]
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"axis": [0, 0, 0]}, "axis"),
        ({"through": "origin"}, "through"),
        ({"speed": 0}, "nothing slides"),
        ({"speed": "3 m/s"}, "speed"),
        ({"body": 3}, "name of a surface"),
    ],
)
def test_wrong_rotation_is_refused(arguments, words):
    with pytest.raises(ValueError, match=words):
        Rotation(**arguments)


def test_structure_that_turns_has_its_speed_in_radians():
    structure = Structure(np.eye(2), np.eye(2), rotation=Rotation(speed=20))
    assert structure.belt_speed == 20.0
    assert structure.with_(belt_speed="60 rpm").belt_speed == pytest.approx(2 * np.pi)
    assert structure.as_dict()["rotation"]["speed"] == 20.0
    assert Structure(np.eye(2), np.eye(2)).belt_speed == 2.0
