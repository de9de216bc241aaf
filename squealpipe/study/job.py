"""Contents of a workflow rule as its script sees them: slice of the study, parameters, files."""

import atexit
import gc
import os
import time
from collections.abc import Callable, Iterable
from contextlib import nullcontext
from functools import cached_property
from typing import Any

import xarray as xr

from squealpipe.parameters import SCENES, Parameters, parameters_of
from squealpipe.reading import for_linear, reading_of
from squealpipe.store import produce
from squealpipe.store.rerun.key import state_key
from squealpipe.study.durations import record_cost
from squealpipe.study.progress.log import QUIET, Log
from squealpipe.systems.one_thread import one_thread


class Job:
    """One job of a rule.

    Attributes:
        settings: slice of the configuration.
        item: part of what is scattered, "i-of-n".
        rule: its name.
        key: of its rule.
    """

    def __init__(self, snakemake: Any, *, tells: bool = False) -> None:
        """Wrap the object ``snakemake`` of a script.

        Args:
            tells: whether what is made prints its progress, as the same work does in a command.
        """
        # as Python ends it would look for cyclic garbage among all that is loaded, for 0.5 s
        atexit.register(gc.freeze)
        self.settings, self.out = snakemake.params.get("settings", {}), snakemake.output
        self.key = snakemake.params.key
        self.item = snakemake.wildcards.get("scatteritem", "1-of-1")
        self.rule = snakemake.rule
        self._log = Log(self.rule) if tells and QUIET not in os.environ else None
        self._since = time.perf_counter()

    @cached_property
    def params(self) -> Parameters:
        """Physical parameters in the rule's reading of the sign of friction."""
        return for_linear(parameters_of(self.settings), self.settings["read_as"])

    def angles(self, scene: str) -> dict[str, float]:
        """Angles of a scene, of the paper or of a study of one's own."""
        scene_angles = (
            self.settings["scenes"][scene]
            if "scenes" in self.settings
            else vars(SCENES[scene])
        )
        return {name: scene_angles[name] for name in ("alpha1", "alpha2")}

    @property
    def model(self) -> str:
        """The model that A1 stands for in that reading."""
        return reading_of(self.settings["read_as"]).a1_model

    def make(
        self,
        task: Callable[[], xr.Dataset],
        output: str | None = None,
        *,
        inputs: Iterable[str] = (),
        **further: Any,
    ) -> None:
        """Run a task and save what it returns, with its provenance.

        Its wall time begins where that of the result before it ended, or the job: what several
        results of a job share is counted once, with the first of them.

        Args:
            further: what it is given beside the slice.
        """
        config, target = {**self.settings, **further}, output or self.out[0]
        progress = nullcontext() if self._log is None else self._log.printed()
        with one_thread(), progress:
            produce(
                task,
                config=config,
                output=target,
                inputs=inputs,
                key=self.key,
                started=self._since,
            )
        self._since = time.perf_counter()
        record_cost(self.rule, self.item)

    def state_keys(self) -> None:
        """End all finished outputs, pictures or pages, with their key."""
        for path in self.out:
            state_key(path, self.key)
        record_cost(self.rule, self.item)
