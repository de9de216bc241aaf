# %% [markdown]
# # What hammering looks and sounds like
# A brake pad of 0.45 kg between two inclined springs is pressed on a belt. At (22°, 46°) friction couples
# its two modes, and the pad is thrown off the belt about 830 times a second. This page makes in Python what
# `squealpipe animate` and `squealpipe listen` write.

# %%
from io import BytesIO

import numpy as np
from IPython.display import HTML, Audio, Image

from squealpipe import Contact, Parameters, Structure, simulate, squealing_modes
from squealpipe.plotting.animation import film_of, phases
from squealpipe.plotting.sound import sound
from squealpipe.structures.squeal.settled_run import squealing_run

pad = Parameters(
    mass=0.45,
    k1=1e7,
    k2=1e7,
    k3=7e6,
    preload=5.714e-4,
    mu=0.37,
    mu_static=0.55,
    friction_speed=1.7,
    friction_law="exponential",
    belt_speed=2.0,
    length1=0.1,
    length2=0.1,
    damping1=42.4,
    damping2=42.4,
)
run = simulate(pad, *np.radians((22.0, 46.0)), t_end=0.3)

# %% [markdown]
# One period takes a second of film. The foot of the pad is blue while it slips, orange while it sticks, and
# red while contact is open, 39 % of the time. At each return the force rises to nearly twice the preload.

# %%
HTML(film_of(run, dpi=90).player())

# %% [markdown]
# The sound is the velocity across the belt, the louder of both components, in the settled part of the run. It
# is repeated where the motion resembles itself most, so that no click is heard.

# %%
heard = sound(run)
print(heard.told())
Audio(heard.wav(2.0))

# %% [markdown]
# On paper a period is a strip of eight phases.

# %%
strip = BytesIO()
phases(run).savefig(strip, format="png")
Image(strip.getvalue())

# %% [markdown]
# Elsewhere the same pad keeps contact and squeals in stick–slip, without a hammer's harsh overtones: at
# (30°, 60°) it sticks to the belt for a part of each period.

# %%
squeal = sound(simulate(pad, *np.radians((30.0, 60.0)), t_end=0.3))
print(squeal.told())
Audio(squeal.wav(2.0))

# %% [markdown]
# The parameters of the paper have no units: the mass moves 0.16 times a second. Played a thousand times
# faster it can be heard, too.

# %%
slow = simulate(Parameters(mu=0.2), 5 * np.pi / 6, 5 * np.pi / 6, t_end=200.0)
paper = sound(slow, speed=1000.0)
print(paper.told())
Audio(paper.wav(2.0))

# %% [markdown]
# The same works for a structure. From files, `squealpipe squeal pad.yaml --run run.nc` writes the motion that
# `animate` and `listen` take. The two pads here, with a caliper between them, have no mesh, so the film shows
# their contacts side by side. Their motion is quasi-periodic.

# %%
stiffness = np.zeros((4, 4))
stiffness[:2, :2] = [[4e7, -1.2e7], [-1.2e7, 1e7]]
stiffness[2:, 2:] = [[6e7, -1.4e7], [-1.4e7, 1e7]]
caliper = np.array([0.0, 1.0, 0.0, -1.0])
pads = Structure(
    0.4 * np.eye(4),
    stiffness + 4e6 * np.outer(caliper, caliper),
    modal_damping=0.01,
    contacts=[
        Contact("inner", {1: 1.0}, {0: 1.0}, stiffness=3e7, preload=2e3),
        Contact("outer", {3: 1.0}, {2: 1.0}, stiffness=5e7, preload=2e3),
    ],
)
motion = squealing_run(pads, squealing_modes(pads, samples=1))
both = sound(motion)
print(both.told())
Audio(both.wav(2.0))

# %%
HTML(film_of(motion, dpi=90).player())
