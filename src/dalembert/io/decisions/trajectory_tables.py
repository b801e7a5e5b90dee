"""The table of model files for trajectories: controls, motion and dimensions at once."""

from __future__ import annotations

from pydantic import Field

from dalembert.design.trajectory.registry import TRAJECTORY_METHODS
from dalembert.io.choices import Record
from dalembert.io.decisions.tables import LIMITS, LimitTable, Names
from dalembert.io.tables import named
from dalembert.io.values import Number, NumberOrBounds, Text

GUESSES = ("line", "simulate")
"""Where a search may begin."""


class TrajectoryTable(Record):
    """Which motion ``dalembert trajectory`` looks for, and the controls that make it."""

    minimize: Text = Field(
        default="time", description='name of a response; `"time"` is the duration'
    )
    controls: Names = Field(description="parameters of forces that become functions of time")
    duration: NumberOrBounds = Field(description="or its bounds `[least, largest]` [s]")
    begin: dict[Text, NumberOrBounds] = Field(
        default_factory=dict,
        description="measure → value or `[lower, upper]`; the start of the model by default",
    )
    end: dict[Text, NumberOrBounds] = Field(
        default_factory=dict, description="measure → value or `[lower, upper]`, `inf` for none"
    )
    cyclic: Names = Field(default_factory=list, description="measures that end as they began")
    subject_to: list[LimitTable] = Field(default_factory=list, description=LIMITS)
    vary: Names = Field(
        default_factory=list, description="parameters that are designed with the motion"
    )
    guess: Text = Field(
        default=None,
        description='`"line"` to the places demanded at the end, by default where there are some, '
        'or `"simulate"`',
    )
    accuracy: Number = Field(
        default=1e-3,
        description="largest distance of the plan and the run under its controls, natural sizes",
    )
    method: named(TRAJECTORY_METHODS) = "DirectCollocation"  # type: ignore[valid-type]
