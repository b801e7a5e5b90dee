"""Methods of trajectory optimisation by name."""

from __future__ import annotations

from dalembert.design.trajectory.collocation import DirectCollocation
from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.shooting import MultipleShooting

TRAJECTORY_METHODS: dict[str, type[TrajectoryMethod]] = {
    "DirectCollocation": DirectCollocation,
    "MultipleShooting": MultipleShooting,
}
