"""The mass that constraint equations see, for weights that know no unit of length."""

from __future__ import annotations

import casadi as ca

LEAST = 1e-6
"""Share of the mean ``C_i M⁻¹ C_iᵀ`` that an equation is given at least: its row may vanish."""


def mean_effective_mass(mass: ca.SX, jacobian: ca.SX, massless: tuple[int, ...]) -> ca.SX:
    """Mean over the equations of ``1/(Σ_k C_ik² / M_kk)``, the mass that moves with each alone.

    A weight of this size puts ``Cᵀ C`` beside ``M`` in any unit and in any coordinates; a mean of
    the masses does not, where speeds are angles and constraints lengths.

    Parameters
    ----------
    mass, jacobian : ``M`` (n, n), ``C`` (m, n)
    massless : speeds without mass, left out
    """
    present = [k for k in range(mass.shape[0]) if k not in massless]
    diagonal = ca.densify(ca.diag(mass))[present]
    if not present:
        return ca.SX(1)
    if not jacobian[:, present].nnz():
        return ca.sum1(diagonal) / len(present)
    mobility = ca.mtimes(jacobian[:, present] ** 2, 1 / diagonal)
    rows = mobility.sparsity().row()
    mean = ca.sum1(mobility) / len(rows)
    mean = ca.if_else(mean > 0, mean, 1)
    return sum((1 / (mobility[i] + LEAST * mean) for i in rows), ca.SX(0)) / len(rows)
