"""The result of a structural analysis: states under load cases and any measure of them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.status import Status
from dalembert.structures.measures import State, Weights
from dalembert.structures.model import StructuralModel
from dalembert.symbolic.expression import Expression, stack

if TYPE_CHECKING:
    import xarray as xr


@dataclass(eq=False, repr=False)
class StructuralResult:
    """Displacements and external forces of a structure under its load cases.

    Attributes
    ----------
    model : StructuralModel that was solved
    analysis : the analysis that made it
    parameters : (np,) values used
    cases : names of the load cases
    displacements, forces : (n, cases); forces are applied ones and reactions
    status : Status
    record : what a gradient needs of each case (the factorised stiffness)
    """

    model: StructuralModel
    analysis: Any
    parameters: np.ndarray
    cases: list[str]
    displacements: np.ndarray
    forces: np.ndarray
    status: Status
    statistics: dict[str, Any] = field(default_factory=dict)
    record: Any = None

    @property
    def time(self) -> np.ndarray:
        """(cases,) numbers of the load cases: what instants are to a motion."""
        return np.arange(len(self.cases), dtype=float)

    def at(self, cases: np.ndarray) -> StructuralResult:
        """The result of some load cases, by number."""
        index = np.asarray(cases, dtype=int)
        return replace(
            self,
            cases=[self.cases[k] for k in index],
            displacements=self.displacements[:, index],
            forces=self.forces[:, index],
            record=[self.record[k] for k in index],
        )

    def state(self, case: int) -> State:
        """Displacements and forces of one case."""
        return State(self.displacements[:, case], self.forces[:, case], self.parameters)

    def case(self, name: str) -> int:
        """Number of a load case.

        Raises
        ------
        AnalysisError
            Unknown name.
        """
        if name not in self.cases:
            known = ", ".join(repr(c) for c in self.cases)
            raise AnalysisError(f"no load case {name!r}; known: {known}")
        return self.cases.index(name)

    def expression(self, measure: str | Expression) -> Expression:
        """A measure by name, or a formula of measures."""
        return measure if isinstance(measure, Expression) else self.model[measure]

    def values(self, measure: str | Expression) -> np.ndarray:
        """(cases,) values of a scalar measure or formula."""
        sx = self.expression(measure).sx
        symbols = self._measured(sx)
        function = ca.Function("formula", [symbols, self.model.p], [sx])
        inputs = (self._numbers(symbols, k) for k in range(len(self.cases)))
        return np.array([float(function(numbers, self.parameters)) for numbers in inputs])

    def __getitem__(self, measure: str | Expression):
        """Value of a measure; an array over the load cases where there are several."""
        found = self.values(measure)
        return float(found[0]) if found.size == 1 else found

    def weights(self, sx: ca.SX, case: int) -> Weights:
        """What a formula of measures and parameters weighs displacements, forces, parameters."""
        symbols = self._measured(sx)
        slopes = [ca.gradient(sx, symbols), ca.gradient(sx, self.model.p)]
        function = ca.Function("slopes", [symbols, self.model.p], slopes)
        found, own = function(self._numbers(symbols, case), self.parameters)
        state, into = self.state(case), Weights.zero(self.forces.shape[0], self.parameters.size)
        into.p += own.full().ravel()
        for symbol, slope in zip(ca.vertsplit(symbols), found.full().ravel(), strict=True):
            self.model.measure(symbol.name()).pull(state, float(slope), into)
        return into

    def _measured(self, sx: ca.SX) -> ca.SX:
        """The symbols in a formula that stand for measures."""
        found = (s for s in ca.symvar(sx) if s.name() not in self.model.parameters)
        return stack(found)

    def _numbers(self, symbols: ca.SX, case: int) -> np.ndarray:
        state, names = self.state(case), [s.name() for s in ca.vertsplit(symbols)]
        return np.array([self.model.measure(name).value(state) for name in names])

    @property
    def data(self) -> xr.Dataset:
        """Displacements and forces with names."""
        import xarray as xr

        names = [f"{node}.{direction}" for node, direction in self.model.degrees]
        coords = {"degree": names, "case": self.cases}
        return xr.Dataset(
            {
                "displacement": (("degree", "case"), self.displacements, {"units": "m or rad"}),
                "external_force": (("degree", "case"), self.forces, {"units": "N or N m"}),
            },
            coords,
            attrs={"model": self.model.name, "status": str(self.status)},
        )

    def __repr__(self) -> str:
        count = len(self.cases)
        return f"<StructuralResult of {self.model.name!r}: {count} load case(s), {self.status}>"
