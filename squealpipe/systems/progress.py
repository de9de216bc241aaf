"""Progress of a long computation, for callers that show it."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TypeVar

Item = TypeVar("Item")


class _Progress:
    """The part of the whole that is computed now, and what takes the share that is done."""

    low, size = 0.0, 1.0
    show: Callable[[float], None] | None = None
    say: Callable[[str], None] | None = None
    name: Callable[[str], None] | None = None
    stage = ""
    stops = False


_progress = _Progress()


def report(share: Callable[[], float]) -> None:
    """Show how much of the present part is done; ``share`` is called only where it is shown."""
    if _progress.show is not None:
        _progress.show(
            _progress.low + _progress.size * min(max(float(share()), 0.0), 1.0)
        )


def partial_answer(line: Callable[[], str]) -> None:
    """Show what is known already; ``line`` is called only where it is shown."""
    if _progress.say is not None:
        _progress.say(line())


@contextmanager
def stage(name: str) -> Iterator[None]:
    """Name the stage that runs within the block; its progress counts from 0 to 1."""
    around = _progress.stage
    with shown(_progress.show, _progress.say, _progress.name):
        _progress.low, _progress.size, _progress.stage = 0.0, 1.0, name
        if _progress.name is not None:
            _progress.name(name)
        try:
            yield
        finally:
            if _progress.name is not None:
                _progress.name(around)


def ask_to_stop(*, stops: bool = True) -> None:
    """Ask long work to end soon and keep its results so far, or withdraw that request."""
    _progress.stops = stops


def stop_is_asked() -> bool:
    """Tell whether the work is to end soon."""
    return _progress.stops


@contextmanager
def part_of_work(first: float, size: float) -> Iterator[None]:
    """Show what is computed meanwhile as so large a part of the work, from a share of it on."""
    low, whole = _progress.low, _progress.size
    _progress.low, _progress.size = low + whole * first, whole * size
    try:
        report(lambda: 0.0)
        yield
    finally:
        _progress.low, _progress.size = low, whole


def with_progress(items: Sequence[Item]) -> Iterator[Item]:
    """The items one after another, each an equal part of the work."""
    for index, item in enumerate(items):
        with part_of_work(index / len(items), 1 / len(items)):
            yield item


@contextmanager
def alone() -> Iterator[Callable[[float], None]]:
    """Take over: what is computed meanwhile shows nothing, and its caller shows its own share."""
    show = _progress.show
    with shown(None, _progress.say, _progress.name):
        yield (
            lambda share: (
                None if show is None else show(_progress.low + _progress.size * share)
            )
        )


@contextmanager
def shown(
    show: Callable[[float], None] | None,
    say: Callable[[str], None] | None = None,
    name: Callable[[str], None] | None = None,
) -> Iterator[None]:
    """Give the share of the whole that is done to ``show`` meanwhile; None shows nothing.

    Args:
        say: takes lines of partial answers.
        name: takes the name of each stage as it begins, and at its end that of the one around it,
            which may be empty.
    """
    before = dict(vars(_progress))
    before.pop("stops", None)
    if _progress.show is None:  # a failed task, whose error is kept, keeps its part
        _progress.low, _progress.size = 0.0, 1.0
    _progress.show, _progress.say, _progress.name = show, say, name
    try:
        yield
    finally:
        stops = _progress.stops
        vars(_progress).clear()
        vars(_progress).update(before, stops=stops)
