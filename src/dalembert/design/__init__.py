"""Design tasks: optimisation, identification, synthesis, reliability, studies."""
