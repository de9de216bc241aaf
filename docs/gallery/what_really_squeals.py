# %% [markdown]
# # Complex eigenvalues of a brake and what really squeals
# Complex eigenvalues name two unstable modes of this elastic pad, and the lower one grows twice as
# fast. Only runs in time tell which of them squeals: from small pushes along both modes and from
# random starts, with every loss of contact located, until the motions have settled. With a pad in
# files, as on the page on complex eigenvalues:
# `squealpipe squeal pad.yaml --n-modes 12 --frequency-max 60kHz -o squeal.nc`; `--onset` follows
# squeal down in friction too, to where it dies: it may last below the critical one.

# %%
from squealpipe import plot, squealing_modes
from squealpipe.structures import elastic_pad

pad = elastic_pad(modal_damping=0.01).reduce(n_modes=12)
answer = squealing_modes(pad, samples=14)
for place in range(answer.sizes["mode"]):
    mode = answer.isel(mode=place)
    print(
        f"mode {int(mode.mode)}: {float(mode.frequency):.0f} Hz, "
        f"grows by {float(mode.growth_rate):.0f} per second, squeals: {bool(mode.squeals)}"
    )

# %% [markdown]
# All of them end in one motion, a cycle at the frequency of the upper mode, in which three of the
# four contact points hammer. The exact map closes it: its largest multiplier is below 1. More modes change
# the fate of the lower one: see the page on accuracy against cost.

# %%
settled = answer.isel(attractor=0)
print(f"frequency {float(settled.dominant_frequency):.0f} Hz")
print(f"largest multiplier {float(settled.largest_multiplier):.4f}")
print("open:", settled.separated_fraction.to_series().round(3).to_dict())

# %%
plot(answer)
