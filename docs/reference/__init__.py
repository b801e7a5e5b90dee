"""What the documentation says again of the code: tables of keys, names and examples."""
