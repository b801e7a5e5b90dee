"""From a builder to frozen equations: system, model, assembly, diagnosis."""
