# %% [markdown]
# # Lyapunov exponent of a system with impacts
# Is a motion chaotic? The growth of a perturbation is carried through every impact exactly, and an
# ensemble gives the exponent over a parameter, with the time up to which a run can be predicted.

# %%
import matplotlib.pyplot as plt
import numpy as np

from squealpipe.systems.shipped.impact_oscillator import impact_oscillator

omega = np.linspace(2.4, 3.0, 241)
runs = impact_oscillator.ensemble(
    2000.0, t_late=1500.0, omega=omega, amplitude=8.0, horizon=True
)

# %%
figure, (above, below) = plt.subplots(2, sharex=True)
above.plot(omega, runs.late_x_min, ",k")
above.plot(omega, runs.late_v_max, ".", markersize=2)
above.set_ylabel("late extremes of x and v")
below.plot(omega, runs.lyapunov_exponent)
below.axhline(0.0, color="0.7")
below.set(xlabel="frequency of the force", ylabel="Lyapunov exponent")
