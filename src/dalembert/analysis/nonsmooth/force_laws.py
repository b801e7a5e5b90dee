"""Normal force laws of a model's contacts, evaluated for many contacts at once."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_source import GapSource
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.laws import NormalLaw
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel

RIGID = -1
"""Number of the law of rigid contacts."""
SMALLEST = 16
"""Number of columns of the smallest mapped function; larger ones have 2, 4, 8 … times as many."""


class ForceLaws:
    """Force laws of all gaps.

    Parameters
    ----------
    model : Model
    sources : of its gaps
    p : (np,) parameters

    Attributes
    ----------
    elements : elements with force laws
    laws : force laws by their numbers
    are_all : whether all contacts have force laws
    """

    def __init__(self, model: Model, sources: list[GapSource], p: np.ndarray):
        elements = [element for source in sources for element in source.elements]
        by_owner = [e.force_laws if isinstance(e, Collisions) else (None,) for e in elements]
        self.p, self._functions, self._kernels = p, [], {}  # type: ignore[var-annotated]
        self.laws: list[NormalLaw] = []
        self.elements = [e for e, laws in zip(elements, by_owner, strict=True) if any(laws)]
        self.are_all = all(law is not None for laws in by_owner for law in laws)
        self._table = np.full((len(elements), max(map(len, by_owner))), RIGID)
        for owner, laws in enumerate(by_owner):
            for number, law in enumerate(laws):
                if law is not None:
                    self._table[owner, number] = len(self._functions)
                    self._functions.append(_function(model, law))
                    self.laws.append(law)

    def of(self, contacts: Contacts) -> np.ndarray:
        """(n,) numbers of the laws of contacts, ``RIGID`` of those without a force law."""
        numbers: np.ndarray = self._table[contacts.owner, contacts.laws.number]
        return numbers

    def compliant(self, contacts: Contacts) -> np.ndarray:
        """(n,) mask of the contacts with a force law."""
        mask: np.ndarray = self.of(contacts) != RIGID
        return mask

    def __call__(self, laws: np.ndarray, depth: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """(4, …) ``N``, ``∂N/∂δ``, ``∂N/∂δ̇`` and the elastic energy at penetrations above zero.

        Parameters
        ----------
        laws : (n,) numbers of the laws
        depth, rate : (n, m) penetrations [m] and their rates [m/s]
        """
        values = np.zeros((4, *depth.shape))
        for number in np.unique(laws):
            own = laws == number
            values[:, own] = self._evaluated(number, depth[own], rate[own])
        return values

    def stored(self, contacts: Contacts) -> float:
        """Elastic energy of compressed contacts [J]."""
        laws = self.of(contacts)
        pressed = (laws != RIGID) & (contacts.distance < 0)
        depth = -contacts.distance[pressed][:, None]
        return float(self(laws[pressed], depth, 0 * depth)[3].sum())

    def _evaluated(self, number: int, depth: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Values of one law."""
        count = depth.size
        size = SMALLEST << max(0, int(np.ceil(np.log2(count / SMALLEST))))
        if (number, size) not in self._kernels:
            mapped = self._functions[number].map(f"force{size}", "serial", size, [1], [])
            self._kernels[number, size] = Kernel(mapped)
        padded = np.arange(size) % count
        state = np.stack([depth.ravel()[padded], rate.ravel()[padded]])
        values = self._kernels[number, size](state, self.p)[0]
        return np.asarray(values[:, :count].reshape(4, *depth.shape))


def _function(model: Model, law: NormalLaw) -> ca.Function:
    """``(δ, δ̇; p) → N, ∂N/∂δ, ∂N/∂δ̇, V``."""
    depth, rate = ca.SX.sym("depth"), ca.SX.sym("rate")
    force, stored = law.force(depth, rate), law.stored(depth)
    slopes = [ca.jacobian(force, s) for s in (depth, rate)]
    outputs = ca.densify(ca.vertcat(force, *slopes, stored))
    return ca.Function("force", [ca.vertcat(depth, rate), model.all_equations.p], [outputs])
