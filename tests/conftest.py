"""Settings common to all tests."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile(
    "dalembert", deadline=None, derandomize=True, max_examples=25, database=None
)
settings.load_profile("dalembert")
