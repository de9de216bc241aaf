"""Record what methods say of the elastic pad's squeal, and their cost, for a page of the gallery.

Some minutes of one core: ``PYTHONPATH=. python tests/benchmarks/record_squeal_ladder.py 1``
writes ``docs/gallery/squeal_ladder/pad_<percent>.nc``, by modal damping in per cent.
"""

import sys
from pathlib import Path

from squealpipe import save, squeal_ladder
from squealpipe.benchmark.machine import processor
from squealpipe.structures import elastic_pad

FOLDER = Path(__file__).parents[2] / "docs/gallery/squeal_ladder"


def main(percents):
    FOLDER.mkdir(exist_ok=True)
    for percent in percents:
        ladder = squeal_ladder(elastic_pad(modal_damping=float(percent) / 100))
        named = ladder.assign_attrs(processor=processor())
        save(named, FOLDER / f"pad_{percent}.nc")


if __name__ == "__main__":
    main(sys.argv[1:] or ["1"])
