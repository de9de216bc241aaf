# %% [markdown]
# # From a CalculiX model to the modes that squeal
# A disc, a lining and a back plate were meshed by hexahedra; CalculiX wrote their matrices
# (`*FREQUENCY, SOLVER=MATRIXSTORAGE`). A short file adds the rest: which surfaces touch, the stiffness and
# pressure of the contact, its friction, and that the disc turns.
#
# `squealpipe init brake.yaml --disc` writes the deck, the matrices, a study of them, and this file, which
# `Structure.read("brake/structure.yaml")` reads:

# %%
import numpy as np

from squealpipe import plot
from squealpipe.cli.structure_example import DISC
from squealpipe.structures import disc_brake

print(DISC)

# %% [markdown]
# `disc_brake()` is the same brake in Python: its matrices agree with those of CalculiX to 12 digits.

# %%
brake = disc_brake()
print(brake.size, "degrees of freedom")
print(len(brake.contacts), "contacts, each with its share of the face:")
print(f"{brake.preloads.min():.1f} to {brake.preloads.max():.1f} N")

# %% [markdown]
# Each node of the lining became a contact with the point of the disc below it. Friction pulls the lining
# along and tips it: in steady sliding its leading edge carries more than its trailing one.

# %%
modes = brake.complex_modes(frequency_max=3000, critical=False)
print(
    modes.normal_force.values.reshape(5, 4).sum(axis=1).round(1),
    "N, row by row along the lining",
)

# %% [markdown]
# Without friction nothing grows. With enough of it one mode is unstable, and its critical friction is located.
# The face has a coefficient of its own, so that coefficient is varied. In a terminal:
# `squealpipe modes brake/structure.yaml --mu lining=0:0.6:4 --frequency-max 3kHz`.

# %%
free = disc_brake(modal_damping=0.001)
over_mu = free.complex_modes(
    mu={"lining": np.linspace(0.0, 0.6, 4)}, frequency_max=3000
)
for number in over_mu.mode.values[over_mu.unstable.any("mu").values]:
    mode = over_mu.sel(mode=number)
    print(
        f"mode {number}: {float(mode.frequency[-1]):.0f} Hz, grows by "
        f"{float(mode.growth_rate[-1]):.0f} per second at mu = 0.6, from mu = "
        f"{float(mode.critical_mu):.3f} on"
    )

# %%
plot(over_mu)

# %% [markdown]
# *How many contacts does it take?* Neighbours may be merged; force and stiffness stay. Here eight points find
# the mode, but its growth differs; two show an unstable mode that does not exist.

# %%
for points in (None, 12, 8, 4, 2):
    merged = disc_brake(mu=0.6, points=points)
    found = merged.complex_modes(frequency_max=3000, critical=False)
    grows = found.unstable.values
    print(
        f"{len(merged.contacts):2d} contacts: {found.frequency.values[grows].round(0)} Hz,",
        f"{found.growth_rate.values[grows].round(1)} 1/s",
    )

# %% [markdown]
# *Which of them squeal, and how loud?* Complex eigenvalues do not say. Runs that locate every loss of contact
# do, in as many modes as the unstable ones need: `squealpipe squeal brake/structure.yaml --frequency-max 4kHz
# -o squeal.nc`, or for the report `squealpipe run --config brake.yaml`. The page on [what really
# squeals](what_really_squeals.py) has such an answer.
