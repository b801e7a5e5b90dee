"""Examples of decisions under doubt: each has a number found elsewhere."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_examples import numbers, pictures, script  # noqa: F401


def test_arm_is_identified(pictures: Path) -> None:  # noqa: F811
    """The true values are known, for the data were made with them."""
    found, made = numbers("identified_arm", pictures), script("identified_arm")
    for name, value in made.TRUE.items():
        assert found[name] == pytest.approx(value, rel=0.05)
    assert found["noise"] == pytest.approx(made.NOISE, rel=0.15)
