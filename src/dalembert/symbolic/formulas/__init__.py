"""What users write wherever a number is accepted."""
