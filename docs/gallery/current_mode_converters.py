# %% [markdown]
# # Power converters: a clock closes the switch, a comparator opens it
# In a buck or boost converter with peak-current control a clock switches the transistor on, and the
# comparator switches it off where the current has reached its limit. The clock is a surface of
# the time alone: it fires where it falls through zero, wherever its regime was entered. A
# higher limit makes the boost converter's periodic motion unstable: its period doubles, and then
# it is chaotic. The branch of its cycles tells where.

# %%
import matplotlib.pyplot as plt
import numpy as np

from squealpipe import Switch, System, labels
from squealpipe.functions import sin

T = 1e-4  # period of the clock, s


def converter(name, rates):
    """A converter whose rates depend on the switch, d = 1 if it is on."""
    return System(
        name,
        states={"i": ("A", 1.0), "v": ("V", 10.0)},
        parameters={"E": 10.0, "L": 1.5e-3, "C": 2e-5, "R": 40.0, "limit": 0.6},
        regimes={"on": {"d": 1.0}, "off": {"d": 0.0}},
        field=rates,
        switches=[
            Switch("peak", "on", lambda t, s, p, r: p.limit - s.i, "off"),
            Switch("tick", "off", lambda t, s, p, r: -sin(2 * np.pi * t / T), "on"),
        ],
        start={"i": 0.2, "v": 5.0, "regime": "on"},
        period=lambda p: T,
        time_scale=T,
    )


buck = converter(
    "buck converter",
    lambda t, s, p, r: {"i": (r.d * p.E - s.v) / p.L, "v": (s.i - s.v / p.R) / p.C},
)
boost = converter(
    "boost converter",
    lambda t, s, p, r: {
        "i": (p.E - (1 - r.d) * s.v) / p.L,
        "v": ((1 - r.d) * s.i - s.v / p.R) / p.C,
    },
)

# %%
cycle = boost.limit_cycle(limit=0.8)
branch = boost.cycle_branch("limit", 1.6, start=cycle, n_points=40)
doubling = labels(branch.label).values.tolist().index("period doubling")
limit = float(branch.limit[doubling])
print(f"the boost converter's period doubles at a limit of {limit:.6f} A")

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
times = np.linspace(200 * T, 206 * T, 601)
for system, value in ((buck, 0.25), (boost, 0.8), (boost, 1.5)):
    run = system.simulate(times[-1], times=times, limit=value)
    left.plot(run.time / T - 200, run.i, label=f"{system.name}, {value} A")
left.set(xlabel="time, periods of the clock", ylabel="current, A", ylim=(-0.2, 2.1))
left.legend(fontsize=7)
ticks = np.arange(300, 360) * T
for value in np.linspace(0.5, 1.6, 111):
    run = boost.simulate(ticks[-1], times=ticks, limit=value)
    right.plot(np.full(ticks.size, value), run.i, "k.", markersize=1)
right.axvline(limit, color="C1")
right.set(xlabel="limit, A", ylabel="current at ticks, A")
