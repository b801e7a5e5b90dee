"""Time integrators for ``ẋ = F(t, x, p)``, independent of mechanisms."""
