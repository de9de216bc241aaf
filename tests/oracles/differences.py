"""Derivatives by central differences."""

import numpy as np


def assert_jacobian(function, at, *, step=1e-6, **tolerance):
    """Of a function that gives values and their derivatives, (values, unknowns)."""
    pairs = (
        (function(at + unit)[0], function(at - unit)[0])
        for unit in step * np.eye(len(at))
    )
    slopes = [(ahead - behind) / (2 * step) for ahead, behind in pairs]
    np.testing.assert_allclose(function(at)[1], np.transpose(slopes), **tolerance)
