"""Methods of trajectory optimisation by name."""

from __future__ import annotations

from dalembert.design.trajectory.collocation import DirectCollocation

TRAJECTORY_METHODS: dict[str, type] = {
    "DirectCollocation": DirectCollocation,
}
