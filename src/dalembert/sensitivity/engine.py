"""What computes gradients of one kind of result; ``registry`` lists them by analysis.

To bring gradients to a new analysis: an engine with ``direct`` and ``adjoint``, and a row there.
Everything else (labels, units, certificates, the command line) follows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.sensitivity.samples import Sample


class Engine:
    """Gradients of sampled responses of one result with respect to all its parameters.

    Parameters
    ----------
    samples : responses of the same result
    """

    def __init__(self, samples: Sequence[Sample]):
        self.samples = list(samples)

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(responses, columns) by one tangent solution for each of these parameters."""
        raise NotImplementedError

    def adjoint(self) -> np.ndarray:
        """(responses, np) by one adjoint solution for each response."""
        raise NotImplementedError

    def of_samples(self, columns: Sequence[int]) -> list[np.ndarray]:
        """(K, columns) derivatives ``∂m_k/∂p`` of the samples themselves, for each response."""
        made = []
        for sample in self.samples:
            alone = np.eye(sample.weights.size)
            each = [replace(sample, weights=row) for row in alone]
            made.append(type(self)(each).direct(columns).reshape(len(each), len(columns)))
        return made

    def gathered(self, rows: Sequence[np.ndarray]) -> np.ndarray:
        """(responses, np) of derivatives (n,) by all of the parameter vector."""
        motion = self.samples[0].motion
        return motion.model.gathered(motion.parameters, np.array(rows))

    def hessian_product(self, direction: np.ndarray) -> np.ndarray:
        """(responses, np) change of the adjoint gradient along a direction of the parameters.

        Raises
        ------
        UnsupportedError
            Second derivatives of this analysis are not available.
        """
        kind = type(self.samples[0].motion.analysis).__name__
        raise UnsupportedError(
            f"second derivatives of {kind} are not available; take differences of gradients"
        )

    def rate(self, sample: Sample, k: int = -1) -> float:
        """``ṁ`` of a sample's measure along the motion, at its ``k``-th instant."""
        raise NotImplementedError


class CombinedEngine(Engine):
    """Linear combinations of responses.

    Parameters
    ----------
    engine : of their terms
    combine : (responses, terms) weights
    """

    def __init__(self, engine: Engine, combine: np.ndarray):
        super().__init__(engine.samples)
        self.engine, self.combine = engine, combine

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return np.asarray(self.combine @ self.engine.direct(columns))

    def adjoint(self) -> np.ndarray:
        return np.asarray(self.combine @ self.engine.adjoint())

    def hessian_product(self, direction: np.ndarray) -> np.ndarray:
        return np.asarray(self.combine @ self.engine.hessian_product(direction))


class RowEngine(Engine):
    """Responses one after the other, each by an object with ``direct(columns)``, ``adjoint()``.

    Such an object is made of a sample and a table that all of them share, for what they have in
    common.
    """

    row: ClassVar[type]

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return np.array([row.direct(columns) for row in self._rows()])

    def adjoint(self) -> np.ndarray:
        return self.gathered([row.adjoint() for row in self._rows()])

    def _rows(self) -> list[Any]:
        shared: dict = {}
        return [self.row(sample, shared) for sample in self.samples]
