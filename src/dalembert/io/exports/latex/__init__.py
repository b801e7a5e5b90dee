"""LaTeX equations of small models."""
