"""Several aims."""
