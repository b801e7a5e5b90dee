"""Command line: ``dalembert check | run | sensitivity | optimize | sweep | report``, and more."""

from dalembert.cli.app import main

__all__ = ["main"]
