"""The files of ``squealpipe init --structure`` and ``--disc``.

Two brake pads on a disc, joined by a caliper, as four degrees of freedom; and a disc brake as
CalculiX writes it.
"""

import gzip

STUDY = """\
# A structure of your own: which of its unstable modes squeal, how loud, why, and what stops it?
# Put your matrices and contacts in place of those in {folder}, then
#   squealpipe modes {matrices} --mu 0:0.8:81   complex eigenvalues, in seconds
#   squealpipe run --config {file}   the report, in minutes at most where modes are few
results: {results}
paper: false

structure:
  file: {folder}/structure.yaml
  samples: 24 # random starts beside a push along each unstable mode
  seed: 0 # that they follow from
  # t_end: 1 s # longest time of a run; by default 8000 periods of the slowest unstable mode
  # n_modes: 12 # to reduce it to; by default as many as errors below 1 % need
  # frequency_max: 10 kHz # highest mode of interest; default: 20 kHz up to 1000 degrees of freedom

# operating: # where it is noisy, at which frequency, as a dynamometer tests it
#   pressure: 0.5:2:4 # factors of all preloads
#   speed: 1:4:4 # m/s
#   mu: [0.3, 0.5] # or temperature: 20:300:3 with mu_of: {{temperature: {{20: 0.5, 300: 0.3}}}}
#   measured: noises.csv # with columns pressure, speed [km/h], mu, frequency [Hz], level [dB]

# modifications: # tried as cures beside friction, preload, damping and the like
#   weight: {{added_mass: {{2: 0.1 kg}}}} # up to 0.1 kg at degree of freedom 2, counted from 1
#   strut:
#     spring: # and dashpot likewise; of a structure with a mesh 5005.3 is a node and its direction
#       1,3: 1e6 N/m
"""
EXAMPLE_FILES = {
    "structure.yaml": """\
# Two pads on a disc, each with one contact. Degrees of freedom: 1 inner pad along the disc, 2 inner
# pad off the disc, 3 and 4 those of the outer pad. SI units; `units: mm-t-s` converts.
mass: mass.mtx # Matrix Market, .npz, .mat, Abaqus *MATRIX OUTPUT or CalculiX .mas
stiffness: stiffness.mtx
contacts: contacts.csv
modal_damping: 0.01 # ratio, of all modes
mu: 0.5
belt_speed: 2.0 # m/s, of the disc under the pads
""",
    "mass.mtx": """\
%%MatrixMarket matrix coordinate real symmetric
% kg: two pads of 0.4 kg
4 4 4
1 1 0.4
2 2 0.4
3 3 0.4
4 4 0.4
""",
    "stiffness.mtx": """\
%%MatrixMarket matrix coordinate real symmetric
% N/m: abutments of both pads, which couple their directions, and a caliper of 4e6 between them
4 4 7
1 1 4.0e7
2 1 -1.2e7
2 2 1.4e7
3 3 6.0e7
4 2 4.0e6
4 3 -1.4e7
4 4 1.4e7
""",
    "contacts.csv": """\
name,normal,tangential,stiffness,preload
inner,2:1,1:1,3e7,2000
outer,4:1,3:1,5e7,2000
""",
}
"""Name → text. A direction is degree of freedom:coefficient, counted from 1."""
DISC_STUDY = """\
# A disc brake from CalculiX: which of its unstable modes squeal, how loud, and why?
# Put your deck and what CalculiX makes of it in place of those in {folder}, then
#   squealpipe modes {matrices} --frequency-max 4kHz   complex eigenvalues, in seconds
#   squealpipe run --config {file}   the report, in minutes
results: {results}
paper: false

structure:
  file: {folder}/structure.yaml
  frequency_max: 4 kHz # highest mode of interest
  samples: 8 # random starts beside a push along each unstable mode
  seed: 0 # that they follow from
  # t_end: 1 s # longest time of a run; by default 8000 periods of the slowest unstable mode
  # n_modes: 12 # to reduce it to; by default as many as errors below 1 % need

# operating: # where it is noisy, at which frequency, as a dynamometer tests it
#   pressure: 2 bar:10 bar:4 # mean pressure of the face
#   speed: 5:40:4 # rad/s
#   mu: [0.4, 0.6] # or temperature: 20:300:3 with mu_of: {{temperature: {{20: 0.6, 300: 0.4}}}}
#   measured: noises.csv # with columns pressure [bar], speed [rpm], frequency [Hz], level [dB]

# modifications: # tried as cures beside friction, preload, damping and the like
#   weight: {{patch: {{nodes: [5080], mass: 0.1 kg}}}} # up to 0.1 kg at a node
#   shim: {{patch: {{nodes: BACK, mass: 50 g, damping_ratio: 0.05}}}} # a node set, a face or a list
#   edge: {{chamfer: {{face: lining, share: 0.2}}}} # up to so much lost, from its leading end
"""
DISC = """\
# A disc, a lining and a back plate. `ccx brake` writes the matrices and the order of their rows
# (brake.sti, brake.mas, brake.dof) from brake.inp, whose step is *FREQUENCY, SOLVER=MATRIXSTORAGE.
units: mm-t-s
mass: brake.mas.gz
stiffness: brake.sti.gz
degrees_of_freedom: brake.dof
mesh: brake.inp # nodes, elements, surfaces
modal_damping: 0.001 # ratio, of all modes
contacts:
  lining: # points lining_1, lining_2, ... at the nodes of PAD_FACE
    surface: PAD_FACE
    against: DISC_FACE
    stiffness: 2.5e6 N/mm # of the whole face
    # tangential_stiffness: 2e6 N/mm # of springs in series with friction: stick gives way
    pressure: 0.5 MPa
    mu: 0.6
rotation: {axis: [0, 0, 1], through: [0, 0, 0], speed: 20 rad/s, body: DISC_FACE}
"""


def disc_files() -> dict[str, str | bytes]:
    """Return the files of the disc brake, name → content: the deck, and what CalculiX writes."""
    from squealpipe.structures.shipped_disc import brake_matrices, brake_mesh, deck

    mesh = brake_mesh()
    mass, stiffness, names = brake_matrices(mesh)
    files: dict[str, str | bytes] = {
        "structure.yaml": DISC,
        "brake.inp": deck(mesh),
        "brake.dof": "".join(f"{name}\n" for name in names),
    }
    for ending, matrix in (("mas", mass), ("sti", stiffness)):
        upper = matrix.tocoo()
        rows = sorted(
            (column, row, value)
            for row, column, value in zip(
                upper.row.tolist(), upper.col.tolist(), upper.data.tolist(), strict=True
            )
            if row <= column
        )
        text = "".join(f"{i + 1} {j + 1} {value:20.13e}\n" for j, i, value in rows)
        # without the time of day, so that the same files come out
        files[f"brake.{ending}.gz"] = gzip.compress(text.encode(), mtime=0)
    return files
