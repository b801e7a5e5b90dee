"""Forward dynamics of mechanisms."""
