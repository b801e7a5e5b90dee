"""Tables of options of analyses: events, damping, spectral densities."""

from __future__ import annotations

from pydantic import Field

from dalembert.io.choices import Record
from dalembert.io.values import Entry, Flag, Integer, Number


class EventTable(Record):
    """An event with its direction and whether it ends the run."""

    measure: Entry
    terminal: Flag = False
    direction: Integer = 0


class RayleighTable(Record):
    """Damping ``C = α M + β K``."""

    mass: Entry = Field(default=0.0, description="α [1/s]")
    stiffness: Entry = Field(default=0.0, description="β [s]")


class DensityTable(Record):
    """A spectral density by points, between which logarithms are interpolated."""

    frequency: list[Number] = Field(description="increasing frequencies [Hz]")
    density: list[Number] = Field(description="one-sided densities [unit²/Hz]")
