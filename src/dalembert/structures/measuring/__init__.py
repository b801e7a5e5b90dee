"""What can be measured on a structure."""
