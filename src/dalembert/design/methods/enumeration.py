"""Exhaustive enumeration of discrete designs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.optimize.program import FEASIBLE, Program
from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.values import Final
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.formulas.expression import stack

BLOCK_SIZE = 200_000
"""Block size of designs whose formulas are evaluated together."""
CANDIDATES = 64
"""Upper limit of the best designs that are run to confirm their formulas."""


@options
class Enumeration(Optimizer):
    """All combinations of integers and catalogue sizes: the global optimum.

    If objective and limits are formulas of parameters alone, designs are ranked by these formulas
    and only the best are run; otherwise every design is run.

    Parameters
    ----------
    max_designs : upper limit of the combinations evaluated by formulas
    max_runs : upper limit of the combinations evaluated by runs

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
        """Whether all variables are discrete and the designs few enough."""
        free = np.flatnonzero(program.is_free())
        if not set(free) <= set(program.variables.sizes):
            return False
        count = _Table.of(program).count
        limit = self.max_runs if _formulas(program) is None else self.max_designs
        return count <= limit

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        table = _Table.of(program)
        formulas = _formulas(program)
        limit, option = (
            (self.max_runs, "max_runs") if formulas is None else (self.max_designs, "max_designs")
        )
        if table.count > limit:
            raise AnalysisError(
                f"there are {table.count:,} designs, more than {option}={limit:,}; narrow bounds, "
                f"raise {option}, or use method='branch-and-bound'"
            )
        ranked = (
            _rank_by_runs(program, table)
            if formulas is None
            else _rank_by_formulas(program, table, formulas)
        )
        for x in ranked:
            z = program.scaled(x)
            evaluation = program.problem.evaluate(x, gradient=False)
            if evaluation is not None and program.violation(evaluation.values) <= FEASIBLE:
                program.record_values(z)
                program.fix_sizes(x)
                return OptimizerResult(z, True, f"enumeration: the best of {table.count:,} designs")
        return OptimizerResult(
            z, False, f"none of {table.count:,} designs runs and satisfies the limits"
        )


@dataclass(frozen=True)
class _Table:
    """Table of all combinations.

    Attributes
    ----------
    sizes : values of each variable
    """

    sizes: list[np.ndarray]

    @classmethod
    def of(cls, program: Program) -> _Table:
        sizes = program.variables.sizes
        for k, name in enumerate(program.variables.names):
            if k not in sizes and program.is_free()[k]:
                raise AnalysisError(
                    f"enumeration needs integers and catalogues, and {name!r} is neither; "
                    "use method='branch-and-bound'"
                )
        indices = range(len(program.variables.names))
        return cls([sizes.get(k, program.lower[k : k + 1]) for k in indices])

    @property
    def count(self) -> int:
        return math.prod(s.size for s in self.sizes)

    def chunks(self) -> Iterator[np.ndarray]:
        """Blocks (n, K) of designs; the last variables vary fastest."""
        split = len(self.sizes)
        while split and math.prod(s.size for s in self.sizes[split - 1 :]) <= BLOCK_SIZE:
            split -= 1
        inner = np.array([x.ravel() for x in np.meshgrid(*self.sizes[split:], indexing="ij")])
        inner = inner.reshape(len(self.sizes) - split, -1)
        for outer in itertools.product(*self.sizes[:split]):
            constant = np.broadcast_to(np.array(outer).reshape(-1, 1), (split, inner.shape[1]))
            yield np.concatenate([constant, inner])


def _formulas(program: Program) -> ca.Function | None:
    """``p → terms`` if they are formulas of parameters alone; None if runs are needed."""
    problem = program.problem
    if len(problem.cases) != 1 or problem.cases[0].inputs:
        return None
    model, symbols = problem.cases[0].model, problem.cases[0].model.parameters.values()
    p = stack(s.sx for s in symbols)
    terms = []
    for _, response in problem.terms:
        if not isinstance(response, Final):
            return None
        formula = model.expression(response.measure).sx
        if not _depends_only_on(formula, p):
            return None
        terms.append(formula)
    return ca.Function("terms", [p], [stack(terms)])


def _depends_only_on(expression: ca.SX, p: ca.SX) -> bool:
    parameters = {p[k].__hash__() for k in range(p.numel())}
    return all(symbol.__hash__() in parameters for symbol in ca.symvar(expression))


def _rank_by_formulas(program: Program, table: _Table, formulas: ca.Function) -> list[np.ndarray]:
    """Best feasible designs by their formulas, in order."""
    best: list[tuple[float, np.ndarray]] = []
    kernels: dict[int, Kernel] = {}  # by sizes of blocks, most of which are equal
    for designs in table.chunks():
        count = designs.shape[1]
        if count not in kernels:
            kernels[count] = Kernel(formulas.map(count))
        terms = kernels[count](_parameters(program, designs))[0]
        values = _values(program, terms)
        feasible = (_violations(program, values) <= FEASIBLE) & np.isfinite(values[0])
        objective = np.where(feasible, program.sign * values[0], np.inf)
        selected = (
            np.argpartition(objective, CANDIDATES - 1)[:CANDIDATES]
            if count > CANDIDATES
            else np.arange(count)
        )
        best += [(float(objective[k]), designs[:, k]) for k in selected if feasible[k]]
        best = sorted(best, key=lambda entry: entry[0])[:CANDIDATES]
    return [x for _, x in best]


def _parameters(program: Program, designs: np.ndarray) -> np.ndarray:
    """(np, K) values of all parameters of the model."""
    model, variables = program.problem.cases[0].model, program.variables
    rows = dict(zip(variables.names, designs, strict=True))
    rows |= {name: np.asarray(curve(designs[k])) for name, k, curve in variables.followers}
    nominal = zip(model.parameters.items(), model.nominal, strict=False)
    count = designs.shape[1]
    return np.array([np.broadcast_to(rows.get(n, value), count) for (n, _), value in nominal])


def _values(program: Program, terms: np.ndarray) -> np.ndarray:
    """(quantities, K) values from terms in columns."""
    problem = program.problem
    rows = []
    for quantity in problem.quantities:
        columns = terms[problem.term_indices(quantity)]
        is_response = quantity.terms == [quantity]
        rows.append(
            columns[0]
            if is_response
            else np.array([quantity.value(column) for column in columns.T])
        )
    return np.array(rows)


def _violations(program: Program, values: np.ndarray) -> np.ndarray:
    """(K,) largest relative violation of a limit."""
    if not program.m:
        return np.zeros(values.shape[1])
    c = values[1:] / program.sizes[:, None]
    over = np.maximum(program.c_lower[:, None] - c, c - program.c_upper[:, None])
    return np.nan_to_num(np.maximum(over.max(axis=0), 0.0), nan=np.inf)


def _rank_by_runs(program: Program, table: _Table) -> list[np.ndarray]:
    """Feasible designs by their runs, in order."""
    ranked: list[tuple[float, np.ndarray]] = []
    for designs in table.chunks():
        for x in designs.T:
            evaluation = program.problem.evaluate(x, gradient=False)
            if evaluation is not None and program.violation(evaluation.values) <= FEASIBLE:
                ranked.append((program.sign * evaluation.values[0], x))
    return [x for _, x in sorted(ranked, key=lambda entry: entry[0])]
