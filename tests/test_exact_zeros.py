"""Zeros of packed columns remain zeros: a node at rest is not shown with a small displacement."""

from __future__ import annotations

import numpy as np
import pytest

from dalembert.report.packing import BITS, pack, unpack


@pytest.mark.parametrize("noise", [0.0, 1.0], ids=["smooth", "noisy"])
def test_zeros_are_exact(noise: float) -> None:
    rng = np.random.default_rng(3)
    column = np.sin(np.linspace(0.1, 9.0, 700)) * 3.7e-4 + noise * rng.normal(0, 2e-4, 700)
    column[[0, 5, 350, 699]] = 0.0
    restored = np.array(unpack(pack({"column of a page": column}))["column of a page"])
    assert (restored[column == 0.0] == 0.0).all()
    span = np.ptp(column)
    assert np.abs(restored - column).max() <= 0.5 * span * 2.0 ** -(BITS - 3)  # noisy: 17 bits
    assert restored.min() >= column.min() - span * 2.0 ** -(BITS - 3)


def test_columns_of_one_sign_begin_at_their_minimum() -> None:
    column = 2.0 + np.sin(np.linspace(0.0, 30.0, 500)) ** 3
    restored = unpack(pack({"values": column}))["values"]
    assert min(restored) == column.min()
