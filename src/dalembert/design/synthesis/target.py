"""Targets of synthesis: paths, motions and functions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dalembert.errors import AnalysisError


def _array(numbers: ArrayLike | None) -> np.ndarray | None:
    return None if numbers is None else np.asarray(numbers, dtype=float)


@dataclass(frozen=True, eq=False)
class Target:
    """Sequence of points, poses or outputs.

    Attributes
    ----------
    points : (n, 2) positions of the coupler point; None if free
    coupler_angles : (n,) rotation of the coupler [rad], relative to any reference line
    outputs : (n,) rotation of the follower [rad], or displacement of the slider, from any origin
    crank_angles : (n,) rotation of the crank [rad], from any origin; None for free timing
    closed : whether the path is closed

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> turn = np.linspace(0, 1, 4)
    >>> twice = da.Target.function(crank_angles=turn, outputs=2 * turn)
    >>> line = da.Target.path([(0, 0), (0.1, 0), (0.2, 0)])
    >>> line.points.shape, line.crank_angles is None  # free timing
    ((3, 2), True)
    """

    points: np.ndarray | None = None
    coupler_angles: np.ndarray | None = None
    outputs: np.ndarray | None = None
    crank_angles: np.ndarray | None = None
    closed: bool = False

    def __post_init__(self) -> None:
        count = 0
        for name in ("points", "coupler_angles", "outputs", "crank_angles"):
            value = getattr(self, name)
            if value is None:
                continue
            array = np.asarray(value, dtype=float)
            shape = (array.shape[0], 2) if name == "points" and array.ndim else (array.size,)
            if array.shape != shape or array.size == 0 or not np.all(np.isfinite(array)):
                entries = "pairs" if name == "points" else "numbers"
                raise AnalysisError(f"{name}: a list of finite {entries} is needed")
            if count and len(array) != count:
                raise AnalysisError(f"{name} has {len(array)} entries, others have {count}")
            count = len(array)
            object.__setattr__(self, name, array)
        if self.points is None and self.outputs is None:
            raise AnalysisError("a target needs points or outputs")
        if count < 2:
            raise AnalysisError(f"a target needs at least two entries, got {count}")

    @classmethod
    def path(
        cls, points: ArrayLike, crank_angles: ArrayLike | None = None, closed: bool = False
    ) -> Target:
        """Path generation, with free or prescribed timing."""
        return cls(_array(points), crank_angles=_array(crank_angles), closed=closed)

    @classmethod
    def motion(
        cls,
        points: ArrayLike,
        coupler_angles: ArrayLike,
        crank_angles: ArrayLike | None = None,
    ) -> Target:
        """Motion generation: the coupler is guided through poses."""
        return cls(_array(points), _array(coupler_angles), crank_angles=_array(crank_angles))

    @classmethod
    def function(cls, crank_angles: ArrayLike, outputs: ArrayLike) -> Target:
        """Function generation: outputs at crank angles."""
        return cls(outputs=_array(outputs), crank_angles=_array(crank_angles))

    def __len__(self) -> int:
        entries = self.points if self.points is not None else self.outputs
        assert entries is not None
        return len(entries)

    @property
    def complex_points(self) -> np.ndarray:
        """Points as complex numbers."""
        assert self.points is not None
        return self.points[:, 0] + 1j * self.points[:, 1]
