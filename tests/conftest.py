"""Settings common to all tests."""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # workers share the cores

from hypothesis import settings

settings.register_profile(
    "dalembert", deadline=None, derandomize=True, max_examples=25, database=None
)
settings.load_profile("dalembert")
