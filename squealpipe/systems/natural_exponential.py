"""Functions that laws need besides + − × and ``**``, for every kind of number."""

import cmath
import math
from functools import singledispatch
from typing import Any


@singledispatch
def exp(value: Any) -> Any:
    """eˣ of floats and arrays; symbolic systems register theirs with ``exp.register``."""
    import numpy as np  # parameters are read without it

    return np.exp(value)


exp.register(float, math.exp)
exp.register(complex, cmath.exp)
