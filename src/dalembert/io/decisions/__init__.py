"""What files ask of designs: responses, cases and tasks."""
