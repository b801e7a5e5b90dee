"""What acts on a structure."""
