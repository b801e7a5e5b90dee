"""The table of model files for synthesis: what a mechanism shall do."""

from __future__ import annotations

from pydantic import Field

from dalembert.io.choices import Record
from dalembert.io.decisions.tables import Bounds
from dalembert.io.values import Flag, Integer, Number, Text, list_of, one_name

TARGETS = ("path", "motion", "function")
"""What a linkage shall do."""
Place = list_of(Number, 2, "x, y")


class SynthesisTable(Record):
    """What the mechanisms that ``dalembert synthesize`` finds shall do."""

    type: one_name(TARGETS) = Field(  # type: ignore[valid-type]
        description='`"path"`, `"motion"` or `"function"`'
    )
    linkage: one_name("dalembert.io.decisions.synthesis:KINDS") = Field(  # type: ignore[valid-type]
        default="FourBar",
        description='`"FourBar"`, `"SliderCrank"`; a six-bar: `"watt I"`, `"watt II"`, '
        '`"stephenson I"`, `"stephenson II"`, `"stephenson III"`; `"geared five-bar"`; '
        '`"own"`, the mechanism of this file',
    )
    joints: dict[Text, Place] = Field(  # type: ignore[valid-type]
        default_factory=dict,
        description="of a six-bar or geared five-bar: joint → `[x, y]` in one position [m]",
    )
    marks: dict[Text, dict[Text, Place]] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="link of it → point → `[x, y]` in the same position"
    )
    reach: Number = Field(
        default=None, description="so far joints and marks may lie to both sides [m]"
    )
    ratio: Number = Field(default=None, description="of the speeds of gears")
    point: Text = Field(
        default="", description="of all but `FourBar` and `SliderCrank`: which shall go there"
    )
    body: Text = Field(default="", description="which is guided, in a motion")
    output: Text = Field(default="", description="measure that a function is about")
    vary: list[Text] = Field(
        default_factory=list, description="parameters; all with bounds by default"
    )
    speed: Number = Field(default=1.0, description="of the motor [rad/s]")
    points: list[Place] = Field(  # type: ignore[valid-type]
        default_factory=list, description="that the coupler point passes [m]"
    )
    file: Text = Field(
        default=None, description="table beside this file instead, columns named as these keys"
    )
    coupler_angles: list[Number] = Field(
        default_factory=list, description="of a motion: how far the coupler turns [rad]"
    )
    outputs: list[Number] = Field(
        default_factory=list, description="of a function: how far the output goes [rad], [m]"
    )
    crank_angles: list[Number] = Field(
        default_factory=list, description="how far the crank turns [rad]; free where none are given"
    )
    closed: Flag = Field(default=False, description="the path leads back to its first point")
    bounds: dict[str, Bounds] = Field(  # type: ignore[valid-type]
        default_factory=dict, description="dimension or parameter → `[lower, upper]`"
    )
    crank_turns: Flag = Field(default=True, description="the crank turns all the way")
    transmission: Number = Field(default=0.0, description="least transmission angle [rad]")
    order: Flag = Field(default=True, description="points are passed in their order")
    starts: Integer = Field(default=24, description="how many are polished")
    rng: Integer = Field(default=0, description="seed of what is drawn")
