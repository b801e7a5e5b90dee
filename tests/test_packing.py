"""Columns of numbers in pages: as exact as pictures need, small, and the same for the browser."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, strategies as st
from report_payload import four_bar
from test_report_page import data_of

from dalembert.report.packing import BITS, EXACT_BITS, ROUGH_BITS, pack, unpack
from dalembert.report.page import render_page

T = np.linspace(0, 10, 20_000)


def read_back(column: np.ndarray) -> np.ndarray:
    document = json.loads(json.dumps(pack({"x": column.tolist()})))
    return np.array(unpack(document)["x"], dtype=float)


@given(
    st.floats(-1e9, 1e9),
    st.floats(1e-9, 1e9),
    st.sampled_from(
        [np.sin, np.exp, np.sign, lambda t: np.random.default_rng(1).normal(size=t.size)]
    ),
)
def test_what_is_read_back_is_near(shift, size, shape):
    column = shift + size * shape(np.linspace(0, 3, 500))
    error = np.abs(read_back(column) - column).max()
    assert error <= np.ptp(column) / 2**ROUGH_BITS + 1e-15 * np.abs(column).max() * 500**2


@pytest.mark.parametrize(
    "column", [np.arange(400.0), np.tile([3.0, -7.0, 1e9], 100), T[::40] * 1e3]
)
def test_whole_and_even_numbers_stay(column):
    assert np.abs(read_back(column) - column).max() <= np.ptp(column) / 2**EXACT_BITS


def test_a_smooth_column_is_kept_to_a_millionth():
    column = np.sin(7 * T)
    assert np.abs(read_back(column) - column).max() <= 2.0 / 2**BITS


def test_gaps_and_constants_stay():
    column = np.sin(T[:300])
    column[[0, 5, 6, 299]] = np.nan
    assert np.array_equal(np.isnan(read_back(column)), np.isnan(column))
    assert np.array_equal(read_back(np.full(300, 0.1)), np.full(300, 0.1))
    assert np.isnan(read_back(np.full(300, np.nan))).all()


def test_packing_twice_is_packing_once():
    payload = four_bar(frames=500)
    assert pack(pack(payload)) == pack(payload)
    assert len({json.dumps(h) for h in pack(payload)["columns"]["heads"]}) > 10


def test_a_long_report_is_small():
    """A four-bar of 20,000 outputs."""
    assert len(render_page(four_bar(frames=20_000, duration=40.0))) < 2e6


def test_short_columns_stay_readable():
    assert data_of(render_page(four_bar(frames=21))).get("columns") is None


@pytest.mark.few(1)
@pytest.mark.parametrize("stream", ["true", "false"])
def test_the_browser_reads_the_same(show, stream):
    """With its own inflation, and where it has none."""
    payload = four_bar(frames=900)
    payload["series"][0]["values"][7] = None
    before = "" if stream == "true" else "delete window.DecompressionStream;"
    page = show(payload, before=before)
    read = page.js("dalembert.motion.series.map((s) => Array.from(s.values))")
    for one, series in zip(read, payload["series"], strict=True):
        arguments = np.array(series["values"], dtype=float)
        values = np.array(one, dtype=float)
        assert np.nanmax(np.abs(values - arguments)) <= 1e-5 * (
            np.nanmax(arguments) - np.nanmin(arguments) + 1e-6 * np.nanmax(np.abs(arguments))
        )
