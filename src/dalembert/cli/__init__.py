"""Command line: ``dalembert check | run | sensitivity | optimize | report | schema | examples``."""

from dalembert.cli.app import main

__all__ = ["main"]
