# %% [markdown]
# # Stick–slip limit cycle
# A mass on a spring rides on a belt. Friction falls with the sliding speed, so steady sliding is
# unstable, and the mass sticks and slips in turn. The cycle is found as a fixed point of its return
# map: its period is exact to round-off, and so are its Floquet multipliers. One of them is 0,
# because sticking forgets how the mass arrived. The oscillator is that of Leine et al. (1998), whose
# period is 12.00103.

# %%
from squealpipe import plot
from squealpipe.systems.shipped.belt_friction import leine_oscillator

cycle = leine_oscillator.limit_cycle()
print(f"period {float(cycle.period):.9f}, stable: {bool(cycle.stable)}")
print("multipliers", cycle.multiplier_real.values.round(9))

# %%
plot(cycle)
