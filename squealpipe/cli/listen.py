"""``squealpipe listen`` and ``animate``: a run as a sound and as a film."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from squealpipe.cli.arguments import Dpi, Force, OutputElsewhere, Share, Time
from squealpipe.cli.console import ExitCodes, answer, say, working
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

    The motion is looped without a click, and cross-faded where it does not repeat: 48 kHz, 16 bit,
    peak −3 dB. A pad's run that is sampled too coarsely is integrated again.

    Example: `squealpipe listen run.nc -o run.wav`

    Args:
        file: run that `squealpipe simulate -o` or `squealpipe squeal --run` wrote, or an answer of
            `squealpipe assess -o` for a pad.
        output: sound to write (.wav); by default FILE.wav, here.
        at: component of a pad's velocity, x (along the belt) or y; of a structure a contact by its
            name or a node by its number, 12, or with its direction: 12.2 is along y. By default
            the loudest.
        seconds: length of the sound, s.
        slow: play it so many times slower, for squeal beyond hearing; 10 lowers 40 kHz to 4 kHz.
        fast: play it so many times faster, for motions below hearing; 1000 suits the paper's
            parameters.
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
    return ExitCodes.done


def animate(
    file: Path,
    /,
    *,
    output: OutputElsewhere = None,
    seconds: Time = 3.0,
    periods: Annotated[Share | None, Parameter(negative="")] = None,
    begin: Time | None = None,
    dpi: Dpi = None,
    force: Force = False,
) -> int:
    """Write a film of the end of a run: pad on its springs or deformed mesh, force and path.

    Contacts are coloured by what they do: slip, stick or open. Without ffmpeg (`pip install
    imageio-ffmpeg`) only .gif and .html can be written.

    Example: `squealpipe animate run.nc -o run.mp4`

    Args:
        file: run that `squealpipe simulate -o` or `squealpipe squeal --run` wrote, or an answer of
            `squealpipe assess -o` for a pad.
        output: film to write (.mp4, .gif or .html); by default FILE.mp4, here.
        seconds: length of the film, s.
        periods: periods of the strongest line that are shown; by default one in each second.
        begin: instant of the run at which the film begins, s; by default the film ends with the
            run.
        dpi: dots per inch of a picture of 8 by 4.5 inches; 120 by default.
    """
    target = Path(file.with_suffix(".mp4").name) if output is None else output
    check_output(target, force=force, kinds=(".mp4", ".gif", ".html"))

    from squealpipe.plotting.animation import film_of
    from squealpipe.plotting.film import NO_FFMPEG, has_ffmpeg, write_film
    from squealpipe.store import load

    if target.suffix == ".mp4" and not has_ffmpeg():
        raise ValueError(NO_FFMPEG)
    run = load(file)

    def again(times: np.ndarray) -> xr.Dataset:
        from squealpipe.brake.dynamics.again import simulated_again

        return simulated_again(run, times)

    made = film_of(
        run,
        seconds=seconds,
        periods=periods,
        begin=begin,
        again=again,
        dpi=120 if dpi is None else dpi,
    )
    with working("film"):
        write_film(made, target, str(run.attrs.get("title", file.name)))
    answer(made.scene.caption)
    say(f"wrote {target}")
    return ExitCodes.done
