"""Ipopt: interior point with a filter line search (Wächter & Biegler 2006), from CasADi."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import casadi as ca
import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult
from dalembert.design.methods.search_options import Stop
from dalembert.design.optimize.program import Program
from dalembert.interrupts import check_ctrl_c
from dalembert.options import options
from dalembert.symbolic.nonlinear_program import ipopt, return_status


@options
class Ipopt(Optimizer):
    """Interior-point method for many variables and limits; Hessians by limited-memory BFGS.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> row = da.Structure("springs in a row")
    >>> a, b = (row.parameter(name, 1.0, bounds=(0.1, 50)) for name in ("a", "b"))
    >>> wall, mid, end = row.node("wall", 0), row.node("mid", 1), row.node("end", 2)
    >>> i = row.add(structures.AxialSpring("i", wall, mid, stiffness=a))
    >>> j = row.add(structures.AxialSpring("j", mid, end, stiffness=b))
    >>> row.support(wall)
    >>> row.load(end, fx=1.0)
    >>> give = da.Limit(da.final("end.ux"), upper=0.5)
    >>> task = dict(minimize=da.final("a + b"), subject_to=[give], analysis=da.Statics())
    >>> best = da.optimize(row.build(), **task, method=da.Ipopt())
    >>> {name: round(value, 3) for name, value in best.x.items()}  # 1/a + 1/b = 0.5
    {'a': 4.0, 'b': 4.0}
    """

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        values = _Values(program)
        z_symbol = ca.MX.sym("z", program.n)
        outputs = values(z_symbol)
        settings = {
            "hessian_approximation": "limited-memory",
            "acceptable_iter": 0,
            "bound_relax_factor": 0.0,
        }
        nlp = {"x": z_symbol, "f": outputs[0], "g": outputs[1:]}
        solver = ipopt("design", nlp, max(stop.tolerance, 1e-10), stop.max_iterations, settings)
        limits = {"lbg": program.c_lower, "ubg": program.c_upper} if program.m else {}
        solution = solver(x0=z, lbx=program.z_lower, ubx=program.z_upper, **limits)
        if values.exception is not None:
            raise values.exception
        check_ctrl_c()
        message, success = f"Ipopt: {return_status(solver)}", bool(solver.stats()["success"])
        return OptimizerResult(np.array(solution["x"]).ravel(), success, message)


class _Values(ca.Callback):
    """``z ↦ [f; c]`` for CasADi; NaN if a run fails, upon which Ipopt shortens the step."""

    def __init__(self, program: Program):
        ca.Callback.__init__(self)
        self.program, self.rows = program, 1 + program.m
        self.exception: BaseException | None = None
        self.jacobian_callback: _Jacobian | None = None
        self.construct("values", {})

    def get_n_in(self) -> int:
        return 1

    def get_n_out(self) -> int:
        return 1

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.program.n, 1)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.rows, 1)

    def guarded(
        self, shape: tuple[int, ...], compute: Callable[[], np.ndarray | None]
    ) -> list[np.ndarray]:
        """Computed value, or NaN; exceptions are stored, as CasADi would discard them."""
        if self.exception is None:
            try:
                value = compute()
                if value is not None:
                    return [value]
            except BaseException as error:
                self.exception = error
        return [np.full(shape, np.nan)]

    def eval(self, arguments: Sequence[ca.DM]) -> list[np.ndarray]:
        def compute() -> np.ndarray | None:
            values = self.program.value(np.array(arguments[0]).ravel())
            return None if values is None else np.concatenate([[values[0]], values[1]])

        return self.guarded((self.rows,), compute)

    def has_jacobian(self) -> bool:
        return True

    def get_jacobian(
        self,
        name: str,
        inputs: Sequence[str],
        outputs: Sequence[str],
        options: Mapping[str, object],
    ) -> ca.Function:
        self.jacobian_callback = _Jacobian(self, name)
        return self.jacobian_callback


class _Jacobian(ca.Callback):
    """``z, [f; c] ↦ ∂[f; c]/∂z``."""

    def __init__(self, values: _Values, name: str):
        ca.Callback.__init__(self)
        self.values = values
        self.construct(name, {})

    def get_n_in(self) -> int:
        return 2

    def get_n_out(self) -> int:
        return 1

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.values.program.n if i == 0 else self.values.rows, 1)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.values.rows, self.values.program.n)

    def eval(self, arguments: Sequence[ca.DM]) -> list[np.ndarray]:
        program = self.values.program

        def compute() -> np.ndarray | None:
            point = program.point(np.array(arguments[0]).ravel())
            return None if point is None else np.vstack([point.g, point.J])

        return self.values.guarded((self.values.rows, program.n), compute)
