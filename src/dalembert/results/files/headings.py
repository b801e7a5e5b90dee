"""Tables whose headings say the unit: ``crank.angle [deg]``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from dalembert.errors import AnalysisError, ModelError
from dalembert.units.unit import shown_in, unit

if TYPE_CHECKING:
    import pandas as pd


def checked_units(units: Sequence[str]) -> tuple[str, ...]:
    """Units that results are wanted in, one for each dimension.

    Raises
    ------
    AnalysisError
        A name that is no unit.
    """
    listed = (units,) if isinstance(units, str) else tuple(units)
    for text in listed:
        try:
            unit(text)
        except ModelError as error:
            raise AnalysisError(f"units: {error.message}") from None
    return listed


def chosen_units(known: Iterable[str], wanted: Sequence[str]) -> dict[str, tuple[float, str]]:
    """SI unit → factor and name of the unit wanted for it, where one is."""
    found = {si: shown_in(si, checked_units(wanted)) for si in sorted(known)}
    return {si: told for si, told in found.items() if told[1] != si}


def headed(table: pd.DataFrame, si: Mapping[str, str], units: Sequence[str]) -> pd.DataFrame:
    """The table in the units wanted, each in the heading of its column.

    Parameters
    ----------
    si : name of a column → unit of its numbers
    units : wanted, such as ``["mm", "deg"]``; each serves what has its dimension
    """
    wanted, made = checked_units(units), {}
    for name in table.columns:
        factor, label = shown_in(si.get(name, ""), wanted)
        heading = f"{name} [{label}]" if label and label != "1" else str(name)
        made[heading] = table[name] if factor == 1.0 else table[name] / factor
    import pandas as pd

    found = pd.DataFrame(made, index=table.index)
    if table.index.name == "time":
        factor, label = shown_in("s", wanted)
        found.index = pd.Index(table.index.to_numpy() / factor, name=f"time [{label}]")
    return found
