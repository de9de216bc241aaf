# %% [markdown]
# # Clutch judder
# A disc on a torsion spring is dragged along by a clutch that slips. Where friction falls with the
# slip speed, the disc is excited at its natural frequency: judder. The clutch sticks and slips by
# events: nothing creeps, and no stiffness is chosen for the stuck state.

# %%
from squealpipe import Switch, System, plot
from squealpipe.functions import exp


def lining(slip, p):
    return 30.0 + p.fall * exp(-slip / 8.0)  # N m over rad/s


def driveline(s):
    return 400.0 * s.twist + 0.05 * s.speed  # N m


def field(t, s, p, r):
    torque = lining(p.engine - s.speed, p) - driveline(s)
    return {"twist": s.speed, "speed": r.slips * torque / 0.1}


engages = lambda t, s, p, r: p.engine - s.speed
holds_no_more = lambda t, s, p, r: lining(0.0, p) - driveline(s)
clutch = System(
    "clutch judder",
    states={"twist": "rad", "speed": "rad/s"},
    parameters={"engine": 4.0, "fall": 10.0},
    regimes={"slip": {"slips": 1.0}, "stick": {"slips": 0.0}},
    field=field,
    switches=[
        Switch(
            "engages", "slip", engages, "stick", lambda t, s, p, r: {"speed": p.engine}
        ),
        Switch("slips", "stick", holds_no_more, "slip"),
    ],
    start={"twist": 0.08, "speed": 0.0, "regime": "slip"},
)
run = clutch.simulate(4.0)
plot(run.isel(time=run.time > 3.6))
