# %% [markdown]
# # Complex eigenvalues of a brake pad, from matrix files
# A finite-element program writes mass and stiffness; a table says where the pad meets the belt: in
# each row degrees of freedom, counted from 1, with coefficients, contact stiffness and preload.
# `pad.yaml` names them. Two pairs of modes turn unstable, at the friction marked. In a terminal the
# last two steps are `squealpipe modes pad.yaml --mu 0:0.8:17 --frequency-max 60e3 -o modes.nc`.

# %%
import csv
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
from scipy.io import mmwrite

from squealpipe import Structure, plot
from squealpipe.structures import elastic_pad

folder = Path(mkdtemp())
shipped = elastic_pad(elements=(12, 3))  # in place of your program's files
mmwrite(folder / "M.mtx", shipped.mass, symmetry="symmetric", precision=17)
mmwrite(folder / "K.mtx", shipped.stiffness, precision=17)
with (folder / "contacts.csv").open("w", newline="") as file:
    table = csv.writer(file)
    table.writerow(["name", "normal", "tangential", "stiffness", "preload"])
    for name, n, t in zip(
        "abcd", shipped.normals.T, shipped.tangentials.T, strict=True
    ):
        table.writerow([name, f"{n.argmax() + 1}:1", f"{t.argmax() + 1}:1", 2e8, 200.0])
(folder / "pad.yaml").write_text(
    "mass: M.mtx\nstiffness: K.mtx\ncontacts: contacts.csv\nmodal_damping: 0.01\n"
)
print((folder / "contacts.csv").read_text())

# %%
pad = Structure.read(folder / "pad.yaml")
modes = pad.complex_modes(mu=np.linspace(0.0, 0.8, 17), frequency_max=60e3)
for number in modes.mode[modes.unstable.any("mu")].values:
    print(
        f"mode {number}: from mu = {modes.critical_mu.sel(mode=number).item():.6f} on"
    )

# %%
plot(modes)
