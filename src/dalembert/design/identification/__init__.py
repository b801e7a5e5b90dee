"""Parameters from measurements: data, misfit, estimate and what it is worth."""
