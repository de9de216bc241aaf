# %% [markdown]
# # Accuracy against cost of a verdict on squeal
# Complex eigenvalues, runs with every event located, and runs with smoothed friction and contact are
# asked the same: what becomes of a push along each of the two unstable modes of the elastic pad?
# Each is held against the finest run, exact events in 32 modes. That takes minutes, so it was done
# beforehand: `tests/benchmarks/record_squeal_ladder.py` writes this file. For a structure of your own:
# `squealpipe ladder pad.yaml -o ladder.nc`, or `squeal_ladder(structure)`.

# %%
from squealpipe import load
from squealpipe.plotting import picture
from squealpipe.study.report.squeal_ladder import lines

ladder = load("docs/gallery/squeal_ladder/pad_1.nc")  # from the root of a checkout
print(*lines(ladder), sep="\n")

# %% [markdown]
# The picture: error against CPU time, in (a) of the frequency, in (b) of the rms speed, in (c) of the
# share of time without contact, the largest over both pushes. Numbers at points are modes, or widths of
# smoothing over the belt's speed (and the preload). Hollow: a motion had not settled; crossed out: a mode
# rings, or none, where another should. Grey: errors below that of the finest run itself. (d): the share
# of time in which a contact is slower than the width of its friction; exact, it sticks.
#
# Complex modes name both modes in 0.04 s, but neither level nor contact loss; exact events in 20 modes
# tell those within 6 % in 0.2 s. In 32 modes they take 0.3 s and smoothed friction a hundred times as
# long, and at a tenth of the belt's speed it is still 6 % too quiet: one contact is slower than that, with
# too little friction, for 8 % of the time; exact, it sticks for 2 %. Twelve modes, enough for the
# frequencies of complex modes within 1 %, are not enough for the verdict: by the end of such a run the
# push along the lower mode rings at the upper one, and so it does with friction and contact smoothed over
# 0.3. Neither motion had settled then.

# %%
picture(ladder)
