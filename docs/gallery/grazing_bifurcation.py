# %% [markdown]
# # Grazing bifurcation of an impact oscillator
# A driven oscillator just touches its stop when the amplitude of the force reaches
# √((1 − ω²)² + c² ω²). The motion without impacts ends there, and one with impacts turns back to
# smaller amplitudes as an unstable branch, up to a fold. Both points are located on the branch.

# %%
from squealpipe import labels, plot
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator

hitting = impact_oscillator.limit_cycle(omega=1.9, amplitude=2.2)
branch = impact_oscillator.cycle_branch("amplitude", 4.0, start=hitting)
for name in ("grazing", "fold"):
    point = labels(branch.label).values.tolist().index(name)
    print(f"{name} at amplitude {float(branch.amplitude[point]):.12f}")
print("grazing by the closed form", ((1 - 1.9**2) ** 2 + 0.01 * 1.9**2) ** 0.5)

# %%
plot(branch)
