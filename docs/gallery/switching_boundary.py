# %% [markdown]
# # Two-parameter curve of a switching boundary
# Where does an oscillator begin to hit its stop, over frequency and amplitude of the force? The curve
# of grazing motions is followed as one curve, without a map of runs. The fold of the motion with one
# impact ends on it, at the point (ω, A) = (1.9974984354, 2.9966648128).

# %%
import matplotlib.pyplot as plt

from squealpipe.systems.shipped.impact_oscillator import impact_oscillator

hitting = impact_oscillator.limit_cycle(omega=1.9, amplitude=2.2)
branch = impact_oscillator.cycle_branch("amplitude", 4.0, start=hitting)
pair = ("omega", "amplitude")
limits = {"omega": (0.8, 3.0), "amplitude": (0.0, 6.0)}
grazing = impact_oscillator.cycle_curve("grazing", pair, start=branch, to=limits)
folds = impact_oscillator.cycle_curve("fold", pair, start=branch, to=limits)
print(
    f"the folds end at {float(folds.omega[-1]):.10f}, {float(folds.amplitude[-1]):.10f}"
)

# %%
plt.plot(grazing.omega, grazing.amplitude, label="grazing")
plt.plot(folds.omega, folds.amplitude, label="fold")
plt.xlabel("frequency of the force")
plt.ylabel("its amplitude")
plt.legend()
