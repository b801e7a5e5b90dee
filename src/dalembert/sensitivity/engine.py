"""What computes gradients of one kind of result; ``registry`` lists them by analysis.

To bring gradients to a new analysis: an engine with ``direct`` and ``adjoint``, and a row there.
Everything else (labels, units, certificates, the command line) follows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

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
