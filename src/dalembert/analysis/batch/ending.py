"""How a batch ends: what was not found side by side runs alone, and all designs have a status."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from typing import Any

import numpy as np

from dalembert.analysis.batch.one_by_one import STOPPED, OneByOne
from dalembert.analysis.batch.states import States
from dalembert.model.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs
from dalembert.results.status import Status


def ended_batch(
    made_by: tuple[Any, Model, Designs, int],
    states: States,
    statuses: dict[int, Status],
    interrupted: bool,
    statistics: Mapping[str, Any],
    begin: float,
) -> Batch:
    """All designs of a batch.

    Parameters
    ----------
    made_by : analysis, model, designs and workers
    states : of the designs that ended as asked
    statuses : number of the design → Status, where that is known
    interrupted : no further design is run
    statistics : what is told beside
    begin : when it all began, by the clock

    Raises
    ------
    DalembertError
        No design could begin, and all for one reason, which then is none of theirs.
    """
    analysis, model, designs, workers = made_by
    count = len(designs)
    passed = [k for k, status in statuses.items() if status.success]
    states.x[np.setdiff1d(np.arange(count), passed)] = np.nan
    runs = OneByOne(analysis, model, designs)
    waiting = [k for k in range(count) if k not in statuses]
    if not interrupted:
        runs.run(waiting, workers, lambda fraction: None)
    for k in waiting:
        statuses[k] = runs.statuses.get(k, STOPPED)
    states.apart = runs.results
    if len(runs.errors) == count and len({s.message for s in statuses.values()}) == 1:
        raise next(iter(runs.errors.values()))
    told = {
        "workers": workers,
        **statistics,
        "designs run on their own": len(waiting),
        "computation time [s]": round(clock.perf_counter() - begin, 6),
    }
    listed = [statuses[k] for k in range(count)]
    return Batch(model, analysis, designs, listed, states, runs.results, told)
