"""All designs of a finite number: exact, whatever the objective is like."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.optimize.program import FEASIBLE, Program
from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.values import Final
from dalembert.symbolic.formulas.expression import stack

AT_ONCE = 200_000
"""Designs whose formulas are evaluated together."""
KEPT = 64
"""Designs that are run, the best first, until one of them does what its formulas say."""


@options
class Enumeration(Optimizer):
    """Every combination of whole numbers and catalogue sizes: the best there is, proved.

    Where objective and limits are formulas of parameters alone, all designs are compared by these
    formulas and only the best is run; otherwise every design is.

    Parameters
    ----------
    max_designs : combinations at most, by formulas
    max_runs : combinations at most, where each is a run

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rod = da.Structure("rod")
    >>> d = rod.parameter("d", 0.02, "m")
    >>> top, end = rod.node("top", 0), rod.node("end", 2)
    >>> area = 0.785398163 * d**2
    >>> part = rod.add(structures.Truss("rod", top, end, area=area, modulus=2e11, density=7850))
    >>> rod.support(top)
    >>> rod.load(end, fx=2e4)
    >>> strong = da.Limit(da.final("rod.stress"), upper=1e8)
    >>> task = dict(minimize=da.final("mass"), subject_to=[strong], analysis=da.Statics())
    >>> search = dict(vary=[da.Catalogue({"d": [0.012, 0.016, 0.02]})], method=da.Enumeration())
    >>> best = da.optimize(rod.build(), **task, **search)
    >>> best.x["d"]  # 16 mm is the first of at least √(4 F/(π σ))
    0.016
    """

    max_designs: int = 20_000_000
    max_runs: int = 20_000

    is_global = True

    def covers(self, program: Program) -> bool:
        """Whether every design can be compared: all variables are discrete, and few enough."""
        free = np.flatnonzero(program.is_free())
        if not set(free) <= set(program.variables.sizes):
            return False
        count = _Table.of(program).count
        limit = self.max_runs if _formulas(program) is None else self.max_designs
        return count <= limit

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
        table = _Table.of(program)
        formulas = _formulas(program)
        most, what = (
            (self.max_runs, "max_runs") if formulas is None else (self.max_designs, "max_designs")
        )
        if table.count > most:
            raise AnalysisError(
                f"there are {table.count:,} designs, more than {what}={most:,}; narrow bounds, "
                f"raise {what}, or take method='branch-and-bound'"
            )
        ranked = _run_all(program, table) if formulas is None else _ranked(program, table, formulas)
        for x in ranked:
            z = program.scaled(x)
            found = program.problem.evaluate(x, gradient=False)
            if found is not None and program.violation(found.values) <= FEASIBLE:
                program.keep(z)
                program.fix_sizes(x)
                return Ended(z, True, f"enumeration: the best of {table.count:,} designs")
        return Ended(z, False, f"none of {table.count:,} designs keeps the limits and runs")


@dataclass(frozen=True)
class _Table:
    """All combinations, by their number.

    Attributes
    ----------
    sizes : values of each variable
    """

    sizes: list[np.ndarray]

    @classmethod
    def of(cls, program: Program) -> _Table:
        known = program.variables.sizes
        for k, name in enumerate(program.variables.names):
            if k not in known and program.is_free()[k]:
                raise AnalysisError(
                    f"enumeration takes whole numbers and catalogues, and {name!r} is neither; "
                    "take method='branch-and-bound'"
                )
        held = range(len(program.variables.names))
        return cls([known.get(k, program.lower[k : k + 1]) for k in held])

    @property
    def count(self) -> int:
        return math.prod(s.size for s in self.sizes)

    def chunks(self) -> Iterator[np.ndarray]:
        """(n, K) designs, the last variables varied first."""
        split = len(self.sizes)
        while split and math.prod(s.size for s in self.sizes[split - 1 :]) <= AT_ONCE:
            split -= 1
        inner = np.array([x.ravel() for x in np.meshgrid(*self.sizes[split:], indexing="ij")])
        inner = inner.reshape(len(self.sizes) - split, -1)
        for outer in itertools.product(*self.sizes[:split]):
            held = np.broadcast_to(np.array(outer).reshape(-1, 1), (split, inner.shape[1]))
            yield np.concatenate([held, inner])


def _formulas(program: Program) -> ca.Function | None:
    """``p → terms`` where they are formulas of parameters alone; None where a run is needed."""
    problem = program.problem
    if len(problem.cases) != 1 or problem.cases[0].given:
        return None
    model, symbols = problem.cases[0].model, problem.cases[0].model.parameters.values()
    p = stack(s.sx for s in symbols)
    terms = []
    for _, response in problem.terms:
        if not isinstance(response, Final):
            return None
        found = model.expression(response.measure).sx
        if not _is_of(found, p):
            return None
        terms.append(found)
    return ca.Function("terms", [p], [stack(terms)])


def _is_of(expression: ca.SX, p: ca.SX) -> bool:
    known = {p[k].__hash__() for k in range(p.numel())}
    return all(symbol.__hash__() in known for symbol in ca.symvar(expression))


def _ranked(program: Program, table: _Table, formulas: ca.Function) -> list[np.ndarray]:
    """The best designs by their formulas, of those that keep the limits."""
    best: list[tuple[float, np.ndarray]] = []
    for designs in table.chunks():
        count = designs.shape[1]
        terms = np.array(formulas.map(count)(_parameters(program, designs)))
        values = _values(program, terms)
        kept = (_violations(program, values) <= FEASIBLE) & np.isfinite(values[0])
        objective = np.where(kept, program.sign * values[0], np.inf)
        few = np.argpartition(objective, KEPT - 1)[:KEPT] if count > KEPT else np.arange(count)
        best += [(float(objective[k]), designs[:, k]) for k in few if kept[k]]
        best = sorted(best, key=lambda one: one[0])[:KEPT]
    return [x for _, x in best]


def _parameters(program: Program, designs: np.ndarray) -> np.ndarray:
    """(np, K) values of all parameters of the model."""
    model, variables = program.problem.cases[0].model, program.variables
    rows = dict(zip(variables.names, designs, strict=True))
    rows |= {name: np.asarray(curve(designs[k])) for name, k, curve in variables.followers}
    known = zip(model.parameters.items(), model.nominal, strict=False)
    count = designs.shape[1]
    return np.array([np.broadcast_to(rows.get(n, value), count) for (n, _), value in known])


def _values(program: Program, terms: np.ndarray) -> np.ndarray:
    """(quantities, K) of terms in columns."""
    problem = program.problem
    rows = []
    for quantity in problem.quantities:
        own = terms[problem.places(quantity)]
        plain = quantity.terms == [quantity]
        rows.append(own[0] if plain else np.array([quantity.value(column) for column in own.T]))
    return np.array(rows)


def _violations(program: Program, values: np.ndarray) -> np.ndarray:
    """(K,) largest relative violation of a limit."""
    if not program.m:
        return np.zeros(values.shape[1])
    c = values[1:] / program.sizes[:, None]
    over = np.maximum(program.c_lower[:, None] - c, c - program.c_upper[:, None])
    return np.nan_to_num(np.maximum(over.max(axis=0), 0.0), nan=np.inf)


def _run_all(program: Program, table: _Table) -> list[np.ndarray]:
    """The designs by what their runs give, the best first."""
    found: list[tuple[float, np.ndarray]] = []
    for designs in table.chunks():
        for x in designs.T:
            made = program.problem.evaluate(x, gradient=False)
            if made is not None and program.violation(made.values) <= FEASIBLE:
                found.append((program.sign * made.values[0], x))
    return [x for _, x in sorted(found, key=lambda one: one[0])]
