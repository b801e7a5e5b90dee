"""Time integrators: they see ``ẋ = F(t, x, p)`` and never a mechanism."""

from dalembert.integrators.runge_kutta import (
    RK4,
    AdaptiveRungeKutta,
    DormandPrince,
    DormandPrince853,
    Euler,
    ExplicitRungeKutta,
    Heun,
    RKGill,
)

__all__ = [
    "RK4",
    "AdaptiveRungeKutta",
    "DormandPrince",
    "DormandPrince853",
    "Euler",
    "ExplicitRungeKutta",
    "Heun",
    "RKGill",
]
