"""Gradients of time histories: ``∂m(t_k)/∂p`` of measures at all outputs, by one solution.

Identification compares time histories with data; its Jacobian has a row for every sample.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.responses.values import At
from dalembert.results.result import Result
from dalembert.sensitivity.gradient import chosen_columns, refuse_unfinished
from dalembert.sensitivity.marching.stable_steps import with_stable_steps
from dalembert.sensitivity.registry import engine_for
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.formulas.expression import Expression


def history_gradients(
    motion: Result, measures: Sequence[str | Expression], wrt: Sequence[str]
) -> list[np.ndarray]:
    """(K, parameters) derivatives of each scalar measure at the outputs of a result.

    Raises
    ------
    AnalysisError
        A run that failed, or an unknown parameter.
    """
    refuse_unfinished(motion)
    columns, motion = chosen_columns(motion, wrt), with_stable_steps(motion)
    samples = [_history(motion, measure) for measure in measures]
    return engine_for(motion)(samples).of_samples(columns)


def history_rates(motion: Result, measure: str | Expression) -> np.ndarray:
    """(K,) ``ṁ`` at the outputs of a result."""
    motion = with_stable_steps(motion)
    sample = _history(motion, measure)
    engine = engine_for(motion)([sample])
    return np.array([engine.rate(sample, k) for k in range(motion.time.size)])


def _history(motion: Result, measure: str | Expression) -> Sample:
    """Sample with all outputs of a result, each with weight 1."""
    expression = motion.expression(measure)
    count = motion.time.size
    zeros = np.zeros(count)
    return Sample(At(measure), motion, expression, 0.0, np.ones(count), zeros, zeros)
