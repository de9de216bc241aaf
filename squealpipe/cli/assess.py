"""``squealpipe assess``: the answer for one pad or structure."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squealpipe.cli.arguments import (
    Angle1OrFile,
    BandOfRuns,
    Drawn,
    ModesOfRuns,
    OptionalAngle2,
    OutputElsewhere,
    Texts,
    Tolerance,
    Whole,
    drawn_output,
    modifications_of,
)
from squealpipe.cli.console import ExitCodes, answer, working
from squealpipe.cli.output import check_output, check_picture, compute, finish, write
from squealpipe.cli.signatures import errors_in_options, options_of
from squealpipe.cli.structures import as_asked, refuse_angles_and_parameters, say_doubts

if TYPE_CHECKING:
    import xarray as xr


@options_of("assess")
def assess(
    alpha1_or_file: Angle1OrFile,
    alpha2: OptionalAngle2 = None,
    /,
    *,
    tol: Tolerance,
    modify: Texts = None,
    samples: Whole,
    seed: Whole,
    n_modes: ModesOfRuns = None,
    frequency_max: BandOfRuns = None,
    output: OutputElsewhere = None,
    brake: Drawn = drawn_output,
) -> int:
    """Say whether a brake squeals or hammers, at which frequency, how loud, why, what stops it.

    A pad on two springs is given by both angles and --config, a structure by its file alone. Exit
    code 0: quiet; 1: not quiet, or undetermined. Angles are counted from the belt line, both
    upwards: alpha1 from +x, the way the belt runs, alpha2 from −x; 0deg is along the belt, 90deg is
    straight above the mass.

    Example: `squealpipe assess 22deg 46deg --config pad.yaml -o answer.nc`

    Args:
        modify: modification of a structure to try as a cure, with its largest amount; repeat for
            more. "weight=added_mass 12 0.1" is up to 0.1 kg at degree of freedom 12, counted from
            1, "strut=spring 12,40 1e6" a spring between two, and dashpot likewise. In a structure
            with a mesh 5005.3 is a node and its direction; "shim=patch BACK 0.2 0.05" is a shim of
            up to 0.2 kg and damping ratio 0.05 on a node set, a face or nodes like 5005,5006, and
            "edge=chamfer lining 0.2" removes up to a fifth of a face's points at its leading end.
        samples: number of random starts of a structure.
        seed: seed of the random starts.
        output: also write the dataset (.nc or .csv), and a picture of the settled motion beside it.
    """
    if isinstance(alpha1_or_file, Path):
        refuse_angles_and_parameters(alpha1_or_file, alpha2, brake.params)
        return _assess_structure(
            alpha1_or_file,
            output,
            brake,
            modify,
            {"samples": samples, "seed": seed, "tol": tol},
            {"n_modes": n_modes, "frequency_max": frequency_max},
        )
    if alpha2 is None:
        raise ValueError(
            "a pad needs both angles, like `squealpipe assess 22deg 46deg`; a structure is one "
            "file, like `squealpipe assess brake.yaml`"
        )
    if modify:
        raise ValueError(
            f"--modify {modify[0]!r}: only structures have modifications; leave it out for a pad"
        )
    if n_modes is not None or frequency_max is not None:
        raise ValueError(
            "--n-modes and --frequency-max reduce structures; leave them out for a pad"
        )
    if output is not None:
        verdict = compute(
            "assess", brake, alpha1_or_file, alpha2, output=output, tol=tol
        )

        from squealpipe.study.report.answer import lines

        answer(*lines(verdict))
    elif brake.picture is not None:
        raise ValueError("--picture is drawn beside a dataset; name that by --output")
    else:
        from squealpipe.brake.assess.assess import judge

        with working("assess"):
            judged = judge(brake.params, alpha1_or_file, alpha2, tol=tol)
        verdict = _told_in_turn(judged)
    return ExitCodes.done if int(verdict.verdict) == 0 else ExitCodes.answer_is_no


def _told_in_turn(judged: Any) -> xr.Dataset:
    """Print the verdict, then what stops it: most of the time goes into that search."""
    from squealpipe.study.report.answer import cure_lines, first_lines

    answer(*first_lines(judged.without_cures()))
    sys.stdout.flush()
    with working("what stops it"):
        verdict: xr.Dataset = judged.with_cures()
    answer(*cure_lines(verdict))
    return verdict


def _assess_structure(
    file: Path,
    output: Path | None,
    brake: Drawn,
    modify: list[str] | None,
    options: dict[str, Any],
    modes: dict[str, Any],
) -> int:
    """Tell the answer for the structure in a file; write it where that is asked for."""
    if output is not None:
        check_output(output, force=brake.force)
        drawn = check_picture(brake.picture, output, force=brake.force)
    elif brake.picture is not None:
        raise ValueError("--picture is drawn beside a dataset; name that by --output")

    import squealpipe
    from squealpipe.structures.assess.assess import judge_structure
    from squealpipe.structures.assess.modifications import read_modification

    whole = squealpipe.Structure.read(file)
    say_doubts(whole)
    named = modifications_of(modify or [])
    for name, content in named.items():  # a mistake is told before modes are computed
        read_modification(name, content, whole, 1.0, first=1)
    stated = options | {"modify": modify or []} | modes
    with errors_in_options():
        structure = as_asked(whole, modes)
        if output is None:
            with working("assess"):
                judged = judge_structure(structure, modifications=named, **options)
            verdict = _told_in_turn(judged)
        else:
            given = {**options, "modifications": named or None}
            with working("assess"):
                verdict = write(
                    lambda: squealpipe.assess(structure, **given),
                    output,
                    config={"parameters": whole.as_dict(), **stated},
                )
            finish(verdict, output, drawn, brake)

            from squealpipe.study.report.answer import lines

            answer(*lines(verdict))
    origin = structure.reduced_from
    limit = None if origin is None else origin.frequency_max
    if limit is not None and float(verdict.frequency) > limit:
        from squealpipe.study.report.squealing import beyond_band

        answer(f"Its frequency is {beyond_band(limit)}.")
    return ExitCodes.done if int(verdict.verdict) == 0 else ExitCodes.answer_is_no
