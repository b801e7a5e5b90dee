"""A sample of the stress test, and its watch over cases that crash, hang or are wrong."""

from __future__ import annotations

import os
import time

import pytest
from stress.families import FAMILIES, judge
from stress.journal import Journal, table
from stress.workers import judged, verdicts

SAMPLE = {
    "planar": [100_001, 100_002],
    "spatial": [100_009],  # an entry of DᵀMD cancels, and its transpose does not
    "flexible": [100_003],
    "contact": [100_004],
    "numbers": [100_000, 100_001, 100_002, 100_003],
    "files": [100_000, 100_001, 100_002, 100_004, 100_006],
}


def test_every_family_has_a_sample():
    assert SAMPLE.keys() == FAMILIES.keys()


@pytest.mark.few(8)
@pytest.mark.parametrize(("family", "seed"), [(f, s) for f in SAMPLE for s in SAMPLE[f]])
def test_sample(family, seed):
    verdict = judged(family, seed, judge)
    assert verdict.sound, str(verdict)


def misbehaving(family: str):
    """A judge for each way in which a case goes wrong."""

    def act(seed: int):
        if family == "error":
            raise ZeroDivisionError("no reason")
        if family == "death":
            os._exit(11)
        if family == "sleep":
            time.sleep(1000)
        return family, "case", "message"

    return act


def test_what_goes_wrong_is_noticed_and_the_rest_goes_on(tmp_path):
    tasks = [(name, 1) for name in ("error", "sleep", "death", "false success", "completed")]
    journal = Journal(tmp_path / "journal.jsonl")
    for verdict in verdicts(tasks, misbehaving, limit=1.0):
        journal.add(verdict)
    again = Journal(tmp_path / "journal.jsonl")
    kinds = {v.family: v.kind for v in again.of(tasks)}
    assert kinds == {
        "error": "crash",
        "death": "crash",
        "sleep": "hang",
        "false success": "false success",
        "completed": "completed",
    }
    assert "ZeroDivisionError" in again.verdicts["error", 1].message
    assert not again.remaining(tasks) and "median" in table(again.of(tasks))
