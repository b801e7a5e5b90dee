"""Dead centres in the studio: zeros of sampled speeds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from studio_scripts import drawn_by


def test_zeros_of_sampled_speeds(tmp_path: Path) -> None:
    """Between samples in steps of 5°, far within a hundredth of a degree; linear at an end."""
    zeros = drawn_by("studio_zeros.mjs", tmp_path)
    assert zeros["zeros"] == pytest.approx(np.pi * (np.arange(3) + 0.5), abs=5e-6)
    assert zeros["line"] == 0.75
