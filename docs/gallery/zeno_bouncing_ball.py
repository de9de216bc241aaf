# %% [markdown]
# # Infinitely many events: the bouncing ball that comes to rest
# Each bounce is shorter than the last, and infinitely many end at one instant, which a closed
# form gives. The run ends there with an outcome that says so; it neither loops for ever nor lets
# the ball fall through the floor.

# %%
from math import sqrt

from squealpipe import labels, plot
from squealpipe.systems.shipped.bouncing_ball import bouncing_ball

run = bouncing_ball.simulate(100.0)
fall, restitution = sqrt(2 * 1.0 / 9.81), 0.9
limit = fall * (1 + 2 * restitution / (1 - restitution))
print(f"outcome: {labels(run.outcome).item()}, after {run.sizes['event']} impacts")
print(f"at {float(run.event_time[-1]):.9f} s; closed form {limit:.9f} s")

# %%
plot(run.isel(time=run.time < 9.0))
