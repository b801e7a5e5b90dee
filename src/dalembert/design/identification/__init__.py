"""Parameter identification: data, misfit, estimate and confidence."""
