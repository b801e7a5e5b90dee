"""Extreme numbers at every option of every registry and in the tables of files."""

from __future__ import annotations

import functools
import os
import tempfile
import warnings
from pathlib import Path
from typing import Any

import absurd_numbers
import numpy as np

from dalembert.budget import VARIABLE
from dalembert.errors import DalembertError

LONGEST = 1000
"""Characters of a message."""


@functools.cache
def cases() -> list[absurd_numbers.Case]:
    """All cases in an order that mixes them."""
    absurd_numbers.FOLDER = Path(tempfile.mkdtemp(prefix="stress-"))
    every = [case for part in absurd_numbers.PARTS.values() for case in part()]
    return [every[k] for k in np.random.default_rng(1).permutation(len(every))]


def judge(seed: int) -> tuple[str, str, str]:
    """Success with finite numbers only, or one typed error of reasonable length."""
    os.environ[VARIABLE] = "0.05"
    try:
        case, act = cases()[seed % len(cases())]
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            result = act()
    except DalembertError as error:
        if len(str(error)) > LONGEST:
            return "crash", case, f"a message of {len(str(error))} characters"
        return "refused", case, str(error)
    finally:
        del os.environ[VARIABLE]
    return judged_result(case, result)


def judged_result(case: str, result: Any) -> tuple[str, str, str]:
    """A successful run holds finite numbers."""
    status = getattr(result, "status", None)
    if status is not None and not status.success:
        return "ended", case, str(status)
    trajectory = getattr(result, "trajectory", None)
    values = [getattr(trajectory, name, None) for name in ("t", "y", "v")]
    if any(v is not None and not np.isfinite(v).all() for v in values):
        return "false success", case, "a completed run holds numbers that are not finite"
    return "completed", case, ""
