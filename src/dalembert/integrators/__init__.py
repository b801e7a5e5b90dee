"""Time integrators: they see ``ẋ = F(t, x, p)`` and never a mechanism."""
