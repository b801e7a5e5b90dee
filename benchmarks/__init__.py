"""dalembert beside its peers on the same mechanisms: ``python -m benchmarks``."""
