"""Record what methods say of the elastic pad's squeal, and their cost, for a page of the gallery.

Some minutes of one core each: ``python tests/benchmarks/record_squeal_ladder.py [percent ...]``
writes ``docs/gallery/squeal_ladder/pad_<percent>.nc``, by modal damping in per cent.
"""

import sys
from pathlib import Path

from squealpipe import save, squeal_ladder
from squealpipe.structures import elastic_pad

FOLDER = Path(__file__).parents[2] / "docs/gallery/squeal_ladder"
PERCENT = ("1", "0.2")


def main(percents):
    FOLDER.mkdir(exist_ok=True)
    for percent in percents:
        pad = elastic_pad(modal_damping=float(percent) / 100)
        save(squeal_ladder(pad), FOLDER / f"pad_{percent}.nc")


if __name__ == "__main__":
    main(sys.argv[1:] or PERCENT)
