"""Static equilibrium, and linearisation about a state."""
