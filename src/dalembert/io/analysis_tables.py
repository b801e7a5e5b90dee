"""Tables of options of analyses: events, damping, spectral densities."""

from __future__ import annotations

from typing import Annotated, Any, Union

from pydantic import BaseModel, Discriminator, Field, Tag

from dalembert.io.choices import PLAIN, Record
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


class CrossDensityTable(Record):
    """A cross spectral density: its parts, or a coherence and a delay."""

    real: Entry | None = Field(default=None, description="real part [unit²/Hz]")
    imag: Entry | None = Field(default=None, description="imaginary part [unit²/Hz]")
    coherence: Entry | None = Field(default=None, description="γ², |S_ab|² = γ² S_a S_b [-]")
    delay: Number | None = Field(default=None, description="of the second input [s]")


def density_type() -> Any:
    """Type of a spectral density: a value, or a table of an input or of two inputs."""
    cross = set(CrossDensityTable.model_fields)

    def choose(value: object) -> str:
        if not isinstance(value, (dict, BaseModel)):
            return PLAIN
        crossing = isinstance(value, dict) and value and set(value) <= cross
        return "cross" if crossing or isinstance(value, CrossDensityTable) else "table"

    members = (
        Annotated[DensityTable, Tag("table")],
        Annotated[CrossDensityTable, Tag("cross")],
        Annotated[Entry, Tag(PLAIN)],
    )
    return Annotated[Union[members], Discriminator(choose)]  # noqa: UP007
