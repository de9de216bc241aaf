# %% [markdown]
# # Derivatives through events
# How does an impact's instant, or the state long after it, depend on a parameter? Differences of runs
# lose half of the digits; automatic differentiation of a solver with events is wrong unless the jump of
# the derivative at each event is included. Here it is, from the system's own symbols.

# %%
import matplotlib.pyplot as plt

from squealpipe.systems.shipped.bouncing_ball import bouncing_ball

run = bouncing_ball.simulate(4.0, sensitivity=("gravity",))
step = 1e-6
later, earlier = (
    bouncing_ball.simulate(4.0, gravity=9.81 + sign * step).event_time
    for sign in (1, -1)
)
by_differences = (later - earlier) / (2 * step)
exact = run.event_time_by_gravity
print(
    "largest difference from differences of runs",
    float(abs(exact - by_differences).max()),
)

# %%
plt.plot(run.event_time, exact, "o-")
plt.xlabel("instant of the impact (s)")
plt.ylabel("its derivative by gravity (s³/m)")
