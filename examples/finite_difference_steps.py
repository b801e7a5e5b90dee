"""Step size of finite differences: example 8.10 of the book, its Tables 8.1 and 8.2.

Two springs in a row carry 1 N and 2 N; the compliance is 9/k1 + 4/k2 = 11 J and its gradient by the
stiffnesses (-9, -1). By k1 a forward difference of step h is -9/(1 + h), a central one -9/(1 -
h^2), until round-off takes over: it grows like eps/h, eps being 2e-16 in double and 1e-7 in single
precision. Therefore a central difference has at most three correct digits in single precision, ten
in double precision.
"""

import sys
from itertools import product
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert.io.spring_deck import load_deck

DECK = Path(__file__).with_name("bridge.dat")
STEPS = tuple(float(f"1e-{k}") for k in range(1, 13))
EXACT = {"d1": -9.0, "d2": -1.0}
SCHEMES = ("forward", "central")
PRECISIONS = {"double": np.float64, "single": np.float32}


def compliance(k: np.ndarray) -> np.floating:
    """``Pᵀ U`` with ``K U = P``, all numbers and operations of the precision of ``k``."""
    (k1, k2), (p1, p2) = k, np.array([1, 2], dtype=k.dtype)
    matrix = np.array([[k1 + k2, -k2], [-k2, k2]])
    factor = matrix[1, 0] / matrix[0, 0]  # Gauss
    u2 = (p2 - factor * p1) / (matrix[1, 1] - factor * matrix[0, 1])
    u1 = (p1 - matrix[0, 1] * u2) / matrix[0, 0]
    return p1 * u1 + p2 * u2


def quotient(parameter: str, scheme: str, h: float, precision: str) -> float:
    """An entry of a table."""
    kind = PRECISIONS[precision]
    k, step = np.array([1, 2], dtype=kind), kind(h)
    shift = np.eye(2, dtype=kind)[list(EXACT).index(parameter)] * step
    if scheme == "forward":
        return float((compliance(k + shift) - compliance(k)) / step)
    return float((compliance(k + shift) - compliance(k - shift)) / (2 * step))


def main(folder=None) -> dict[str, float]:
    result = da.solve_statics(load_deck(DECK).build())
    response = da.final("compliance", name="compliance")
    numbers = {"compliance": result["compliance"]}
    for precision, scheme, name in product(PRECISIONS, SCHEMES, EXACT):
        for h in STEPS:
            found = quotient(name, scheme, h, precision)
            numbers[f"{precision} {scheme} {name} {h:.0e}"] = found
    show(numbers)
    for name, value in (("d1", 1.0), ("d2", 2.0)):
        steps = [h / value for h in STEPS[:6]]  # relative; those of the book are absolute
        study = da.step_study(result, response, name, steps, SCHEMES)
        print(study)
        numbers[f"gradient {name}"] = study.exact
        table = [[numbers[f"double {s} {name} {h:.0e}"] for h in STEPS[:6]] for s in SCHEMES]
        numbers[f"study against table {name}"] = float(abs(study.data["value"] - table).max())
    if folder:
        draw(numbers, folder)
    return numbers


def show(numbers: dict[str, float]) -> None:
    """The two tables."""
    for precision in PRECISIONS:
        print(f"{precision} precision\n   step  " + f"{'forward':>15}{'central':>15}" * 2)
        for h in STEPS:
            row = [numbers[f"{precision} {s} {d} {h:.0e}"] for d in EXACT for s in SCHEMES]
            print(f"  {h:.0e}  " + "".join(f"{x:15.9f}" for x in row))


def draw(numbers: dict[str, float], folder) -> None:
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), sharex=True, sharey=True)
    for ax, (precision, kind) in zip(axes, PRECISIONS.items(), strict=True):
        for scheme, colour, marker in zip(SCHEMES, style.COLOURS, "os", strict=False):
            found = np.array([numbers[f"{precision} {scheme} d1 {h:.0e}"] for h in STEPS])
            error = np.maximum(abs(found / EXACT["d1"] - 1), 1e-16)
            ax.loglog(STEPS, error, marker=marker, ms=4.5, color=colour, label=scheme)
        eps = np.finfo(kind).eps
        ax.loglog(STEPS, np.minimum(eps / np.array(STEPS), 1), color="0.6", lw=0.9, ls="--")
        place = min(1e11 * eps, 1e-2)
        ax.annotate("eps/h", (place, eps / place), (-34, -8), textcoords="offset points")
        ax.set(title=f"{precision} precision", xlabel="perturbation of k1 [N/m]")
    axes[0].set(ylabel="relative error of the sensitivity", ylim=(1e-13, 10))
    axes[0].legend(loc="lower right")
    style.save(figure, folder, "finite_difference_steps")


if __name__ == "__main__":
    main(*sys.argv[1:])
