"""Normal force laws of a model's contacts, evaluated for many contacts at once."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_source import GapSource
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.laws import NormalLaw
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.mapped_kernel import MappedKernel

RIGID = -1
"""Number of the law of rigid contacts."""


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
        self.p, self._functions = p, list[MappedKernel]()
        self.laws: list[NormalLaw] = []
        self.elements = [e for e, laws in zip(elements, by_owner, strict=True) if any(laws)]
        self.are_all = all(law is not None for laws in by_owner for law in laws)
        self._table = np.full((len(elements), max(map(len, by_owner))), RIGID)
        for owner, laws in enumerate(by_owner):
            for number, law in enumerate(laws):
                if law is not None:
                    self._table[owner, number] = len(self._functions)
                    self._functions.append(MappedKernel(_function(model, law), common=[1]))
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

    def compression(self, contacts: Contacts) -> tuple[float, float]:
        """Elastic energy of compressed contacts [J], and their largest penetration [m]."""
        laws = self.of(contacts)
        pressed = (laws != RIGID) & (contacts.distance < 0)
        depth = -contacts.distance[pressed][:, None]
        energies = self(laws[pressed], depth, 0 * depth)[3]
        return float(energies.sum()), float(depth.max(initial=0.0))

    def _evaluated(self, number: int, depth: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Values of one law."""
        state = np.stack([depth.ravel(), rate.ravel()])
        values = self._functions[number](state, self.p)[0]
        return values[..., 0].T.reshape(4, *depth.shape)


def _function(model: Model, law: NormalLaw) -> ca.Function:
    """``(δ, δ̇; p) → N, ∂N/∂δ, ∂N/∂δ̇, V``."""
    depth, rate = ca.SX.sym("depth"), ca.SX.sym("rate")
    force, stored = law.force(depth, rate), law.stored(depth)
    slopes = [ca.jacobian(force, s) for s in (depth, rate)]
    outputs = ca.densify(ca.vertcat(force, *slopes, stored))
    return ca.Function("force", [ca.vertcat(depth, rate), model.all_equations.p], [outputs])
