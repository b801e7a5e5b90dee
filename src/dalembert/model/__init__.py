"""Models: the builder, and the two evaluators of what it builds."""
