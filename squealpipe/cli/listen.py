"""``squealpipe listen`` and ``animate``: a run as a sound and as a film."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from squealpipe.cli.arguments import Force, OutputElsewhere, Share, Time
from squealpipe.cli.console import DONE, answer, say
from squealpipe.cli.output import check_output

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr


def listen(
    file: Path,
    /,
    *,
    output: OutputElsewhere = None,
    at: str | None = None,
    seconds: Time = 3.0,
    slow: Annotated[Share, Parameter(negative="")] = 1.0,
    fast: Annotated[Share, Parameter(negative="")] = 1.0,
    force: Force = False,
) -> int:
    """Write what a run sounds like: the velocity of its settled part as a wav file.

    The motion is looped without a click and cross-faded where it does not repeat, 48 kHz, 16 bit,
    peak −3 dB. A run that is sampled too coarsely is integrated again.

    Example: `squealpipe listen run.nc -o run.wav`

    Args:
        file: run that `squealpipe simulate -o` wrote.
        output: sound to write (.wav); by default FILE.wav, here.
        at: component of the velocity, x (along the belt) or y; by default the louder one.
        seconds: length of the sound, s.
        slow: play it so many times slower, for squeal beyond hearing: 10 makes 40 kHz 4 kHz.
        fast: play it so many times faster, for motions below hearing, as those of the paper's
            parameters: 1000.
    """
    if slow != 1.0 and fast != 1.0:
        raise ValueError("--slow and --fast contradict one another; give one of them")
    target = Path(file.with_suffix(".wav").name) if output is None else output
    check_output(target, force=force, kinds=(".wav",))

    from squealpipe.plotting.sound import sound, write_wav
    from squealpipe.store import load

    run = load(file)

    counts: list[int] = []

    def again(times: np.ndarray) -> xr.Dataset:
        from squealpipe.brake.dynamics.again import simulated_again

        counts.append(times.size)
        return simulated_again(run, times)

    heard = sound(run, at=at, seconds=seconds, speed=fast / slow, again=again)
    if counts:
        say(
            "the run was sampled too coarsely to be heard, and was integrated again at "
            f"{counts[-1]} instants"
        )
    write_wav(heard, target, seconds)
    answer(heard.told())
    say(f"wrote {target}")
    return DONE
