"""Arrays that compiled loops work on, from the addresses of a table."""

from typing import Any

import numpy as np

from squealpipe.systems.compiled import inline_views
from squealpipe.systems.taylor import layout
from squealpipe.systems.taylor.lanes import view
from squealpipe.systems.taylor.simd import LANES


@inline_views
def memory_of(t: Any) -> Any:
    """Return the arrays of a table of addresses, but for those of the series."""
    n_events = t.n_surfaces + t.n_outputs
    width = max(3 * n_events, t.n_variables, t.n_constants) + 2
    size = t.n_states
    return layout.Memory(
        rows=view(t.rows, (t.n_rows, LANES), np.float64),
        integers=view(
            t.integers, (layout.integers.first_regime + t.n_components, LANES), np.int64
        ),
        sizes=view(t.sizes, (t.n_jobs, size), np.float64),
        units=view(t.units, (size, LANES), np.float64),
        tracked=view(t.tracked, (t.n_tracked, 2), np.int64),
        regimes=view(t.regimes, (t.n_regimes, t.n_table), np.float64),
        falls=view(t.falls, (t.n_regimes, t.n_surfaces), np.int64),
        rises=view(t.rises, (t.n_regimes, t.n_surfaces), np.int64),
        component_of=view(t.component_of, (t.n_regimes,), np.int64),
        first_constant=view(t.first_constant, (t.n_components + 1,), np.int64),
        owner=view(t.owner, (t.n_surfaces,), np.int64),
        marks=view(t.marks, (t.n_regimes, t.n_surfaces), np.int64),
        clocks=view(t.clocks, (t.n_surfaces,), np.int64),
        ticked=view(t.ticked, (t.n_surfaces, LANES), np.float64),
        active=view(t.active, (n_events,), np.int64),
        fresh=view(t.fresh, (t.n_surfaces,), np.int64),
        beyond=view(t.beyond, (t.n_surfaces,), np.int64),
        exact=view(t.exact, (size + n_events, LANES), np.float64),
        steep=view(t.steep, (size,), np.int64),
        bent=view(t.bent, (n_events,), np.int64),
        share=view(t.share, (3,), np.float64),
        noise=view(t.noise, (t.n_surfaces, 2, LANES), np.float64),
        scratch=view(t.scratch, (6, width), np.float64),
        initial=view(t.initial, (t.n_jobs, size), np.float64),
        parameters=view(t.parameters, (t.n_jobs, t.n_parameters), np.float64),
        first_regime=view(t.first_regime, (t.n_jobs, t.n_components), np.int64),
        limits=view(t.limits, (t.n_jobs, 7), np.float64),
        final=view(t.final, (t.n_jobs, size), np.float64),
        extremes=view(t.extremes, (t.n_jobs, t.n_tracked, 2, 2), np.float64),
        logs=view(t.logs, (t.n_kinds,), np.int64),
        counts=view(t.counts, (t.n_jobs, t.n_kinds), np.int64),
        firsts=view(t.firsts, (t.n_jobs, t.n_kinds), np.float64),
        durations=view(t.durations, (t.n_jobs, t.n_regimes), np.float64),
        ends=view(t.ends, (t.n_jobs, 3), np.int64),
        summary=view(t.summary, (t.n_jobs, 3), np.float64),
        sample_times=view(t.sample_times, (t.n_jobs, t.n_samples), np.float64),
        samples=view(t.samples, (t.n_jobs, t.n_samples, size), np.float64),
        sample_regimes=view(
            t.sample_regimes, (t.n_jobs, t.n_samples, t.n_components), np.int64
        ),
        sample_sums=view(t.sample_sums, (t.n_jobs, t.n_samples, t.n_sums), np.float64),
        sample_extremes=view(
            t.sample_extremes, (t.n_jobs, t.n_between, t.n_tracked, 2), np.float64
        ),
        between=view(t.between, (t.n_tracked, 2, LANES), np.float64),
        event_times=view(t.event_times, (t.n_jobs, t.n_logged), np.float64),
        event_kinds=view(t.event_kinds, (t.n_jobs, t.n_logged), np.int64),
        event_regimes=view(t.event_regimes, (t.n_jobs, t.n_logged), np.int64),
        event_states=view(t.event_states, (t.n_jobs, t.n_logged, size), np.float64),
        peaks=view(t.peaks, (t.n_jobs, t.n_kinds, size), np.float64),
        points=view(t.points, (t.n_jobs, t.n_points, 2), np.float64),
        half_turns=view(t.half_turns, (t.n_jobs, t.n_points), np.float64),
        queue=view(t.queue, (3,), np.int64),
        suspects=view(t.suspects, (t.n_surfaces,), np.int64),
    )
