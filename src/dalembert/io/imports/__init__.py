"""Import of models from files of other programs."""
