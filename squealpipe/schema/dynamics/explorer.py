"""The dataset behind the explorer page: motions, spectra and backbones on a grid of angles."""

from dataclasses import replace

from squealpipe.schema import ORBIT_ENDS, RUN_ENDS, DatasetSchema, Variable, or_nan, outcome
from squealpipe.schema.dynamics.runs import FREQUENCY, TIME
from squealpipe.schema.linear import ANGLES, MAP, MODES

RUN = (*MAP, "time")
BRANCH = (*MAP, "mode", "point")


def _motion(units: str, long_name: str) -> Variable:
    """A history, kept in single precision: it is drawn, not computed with."""
    return Variable(long_name, units, RUN, dtype="f4", rtol=1e-5, atol=1e-6)


def _branch(units: str, long_name: str) -> Variable:
    return or_nan(long_name, units, BRANCH, dtype="f4", rtol=1e-5, atol=1e-6, optional=True)


EXPLORER = DatasetSchema(
    name="explorer",
    title="Motions from rest (A1), their spectra, and exact backbones (A4) over both angles",
    coordinates={
        **ANGLES,
        **{name: replace(entry, optional=True) for name, entry in MODES.items()},
        "time": TIME,
        "frequency": FREQUENCY,
        "point": Variable("point along the branch", dims=("point",), dtype="i4", optional=True),
    },
    variables={
        "x": _motion("m", "displacement along the belt"),
        "y": _motion("m", "displacement away from the belt"),
        "normalized_contact_force": _motion("1", "contact force over k3 l_pre"),
        "force_spectrum": Variable(
            "amplitude spectrum of the normalized contact force",
            dims=(*MAP, "frequency"),
            dtype="f4",
            rtol=1e-4,
            atol=1e-5,
        ),
        "outcome": outcome(*MAP, among=RUN_ENDS),
        "omega": _branch("rad s-1", "angular frequency of the periodic motion"),
        "x_amplitude": _branch("m", "half of the peak-to-peak of x over a period"),
        "y_amplitude": _branch("m", "half of the peak-to-peak of y over a period"),
        "y_peak": _branch("m", "y at the symmetric instant with the larger y"),
        "stability_index": _branch("1", "trace of the monodromy matrix minus 2"),
        "end": Variable(
            "why the branch ends",
            dims=(*MAP, "mode"),
            flags=outcome(among=ORBIT_ENDS).flags,
            optional=True,
        ),
        "preload": Variable("precompression l_pre of the contact spring", "m"),
        "length1": Variable("free length of spring 1", "m"),
        "length2": Variable("free length of spring 2", "m"),
        "belt_speed": Variable("belt speed V", "m s-1"),
    },
)
