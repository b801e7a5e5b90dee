"""Consistency of the spectral densities of correlated inputs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from dalembert.errors import AnalysisError

Pair = tuple[str, str]
"""Names of two inputs."""
EXCESS = 1e-9
"""Negative eigenvalue of a coherence matrix that counts as rounding [-]."""


def check_coherence(
    inputs: list[str],
    own: Mapping[str, np.ndarray],
    cross: Mapping[Pair, np.ndarray],
    frequencies: np.ndarray,
) -> None:
    """Raise unless the matrices of all densities are positive semidefinite.

    Parameters
    ----------
    inputs : names
    own, cross : densities (K,) of inputs and of pairs
    frequencies : (K,) [Hz]

    Raises
    ------
    AnalysisError
        Names the frequency, and the pair with the largest coherence.
    """
    if not cross or not frequencies.size:
        return
    place = {name: k for k, name in enumerate(inputs)}
    coherence = np.tile(np.eye(len(inputs), dtype=complex), (frequencies.size, 1, 1))
    for (a, b), values in cross.items():
        size = np.sqrt(own[a] * own[b])
        nothing = (size == 0) & (values == 0)
        share = np.divide(values, size, out=np.full(values.shape, np.inf, complex), where=size > 0)
        share[nothing] = 0.0
        if (worst := int(np.argmax(np.abs(share)))) >= 0 and abs(share[worst]) > 1 + EXCESS:
            raise AnalysisError(
                f"RandomResponse: psd[{a}, {b}] has the magnitude {abs(values[worst]):.6g} at "
                f"{frequencies[worst]:.6g} Hz, above √(S_a S_b) = {size[worst]:.6g}; correlated "
                "inputs have at most this one"
            )
        coherence[:, place[a], place[b]] = share
        coherence[:, place[b], place[a]] = share.conj()
    lowest = np.linalg.eigvalsh(coherence)[:, 0]
    if (worst := int(np.argmin(lowest))) >= 0 and lowest[worst] < -EXCESS * len(inputs):
        raise AnalysisError(
            f"RandomResponse: the densities of {', '.join(inputs)} contradict each other at "
            f"{frequencies[worst]:.6g} Hz: their matrix is not positive semidefinite"
        )
