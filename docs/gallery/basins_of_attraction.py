# %% [markdown]
# # Basins of attraction: sliding or stick–slip
# One brake, two motions: steady sliding is stable, and a stick–slip cycle exists beside it. Which of
# them a start leads to is computed for a grid of starts, and the share of starts that end in rest
# follows. The oscillator is the case study of bSTAB, whose exact share at this belt speed is 0.2123.

# %%
import matplotlib.pyplot as plt
import numpy as np

from squealpipe import labels
from squealpipe.systems.shipped.belt_friction import exponential_oscillator

starts = {"x": np.linspace(-2, 2, 41), "v": np.linspace(0, 2, 31)}
ends = exponential_oscillator.basin(1500.0, start=starts, belt_speed=1.4)
at_rest = labels(ends.motion) == "rest"
print(f"{float(at_rest.mean()):.3f} of the starts come to steady sliding")

# %%
plt.pcolormesh(ends.x0, ends.v0, at_rest.T, cmap="Blues")
plt.xlabel("x at the start")
plt.ylabel("velocity at the start")
