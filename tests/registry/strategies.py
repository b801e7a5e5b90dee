"""Every formulation, stabilisation and integrator, once."""

from __future__ import annotations

import dalembert as da

FORMULATIONS = {
    "KKT": da.KKT(),
    "RangeSpace": da.RangeSpace(),
    "DAE": da.DAE(),
    "AugmentedLagrangian": da.AugmentedLagrangian(),
    "NullSpace": da.NullSpace(),
    "NullSpace qr": da.NullSpace("qr"),
    "NullSpace gram-schmidt": da.NullSpace("gram-schmidt"),
    "NullSpace svd": da.NullSpace("svd"),
    "VelocityPartitioning": da.VelocityPartitioning(),
}
SOFT = {"Penalty": da.Penalty()}
"""Formulations that hold the constraints only nearly."""
STABILIZATIONS = {
    "none": da.Stabilization(),
    "Baumgarte": da.Baumgarte(),
    "Projection": da.Projection(),
    "EnergyProjection": da.EnergyProjection(),
}
INTEGRATORS = {
    "AutomaticIntegrator": da.AutomaticIntegrator(),
    "Euler": da.Euler(),
    "Heun": da.Heun(),
    "RK4": da.RK4(),
    "RKGill": da.RKGill(),
    "DormandPrince": da.DormandPrince(),
    "DormandPrince853": da.DormandPrince853(),
    "BackwardEuler": da.BackwardEuler(),
    "Trapezoidal": da.Trapezoidal(),
    "Newmark": da.Newmark(),
    "HHT": da.HHT(),
    "GeneralizedAlpha": da.GeneralizedAlpha(),
    "Radau": da.Radau(),
    "BDF": da.BDF(),
    "CVODES": da.CVODES(),
    "IDA": da.IDA(),
}
