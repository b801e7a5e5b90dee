"""Time integrators: they see ``ẋ = F(t, x, p)`` and never a mechanism."""

from dalembert.integrators.runge_kutta import (
    RK4,
    DormandPrince,
    ExplicitRungeKutta,
    RKGill,
)

__all__ = ["RK4", "DormandPrince", "ExplicitRungeKutta", "RKGill"]
