"""Python scripts of model files."""
