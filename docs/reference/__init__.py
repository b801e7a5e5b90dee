"""Generated tables of the documentation: keys, names and examples."""
