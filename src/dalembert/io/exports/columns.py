"""Measures of results as named columns with units."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.errors import DalembertError
from dalembert.results.batch.batch import Batch
from dalembert.results.labelled import measured_series
from dalembert.results.modes import Numbered
from dalembert.results.structural.result import measure_table
from dalembert.results.structural.states import StructuralStates


@dataclass(frozen=True)
class Column:
    """A measure.

    Attributes
    ----------
    values : (K,), of batches (designs, K)
    """

    name: str
    unit: str
    values: np.ndarray


@dataclass(frozen=True)
class Table:
    """Measures of a result along its instants, load cases or modes.

    Attributes
    ----------
    along : instants, names of the load cases or numbers of the modes
    columns : the measures
    designs : varied parameters of the designs of a batch
    parameters : the parameters with their values, of a batch those common to all designs
    attributes : name of the model, status
    """

    along: Column
    columns: list[Column]
    designs: list[Column]
    parameters: list[Column]
    attributes: dict[str, str]


def table_of(result: Any) -> Table:
    """All scalar measures of a result."""
    if isinstance(result, Batch):
        return _batch_table(result)
    names = list(result.model.parameters.values())
    values = zip(names, result.parameters, strict=False)
    parameters = [Column(p.name, p.unit, np.array([value])) for p, value in values]
    attributes = {"model": result.model.name, "status": str(result.status)}
    return Table(_along(result), list(_columns(result)), [], parameters, attributes)


def _along(result: Any) -> Column:
    if isinstance(result, Numbered):
        return Column("mode", "", np.asarray(result.numbers))
    if isinstance(result, StructuralStates) and not result.in_sequence:
        return Column("case", "", np.array([str(case) or "value" for case in result.cases]))
    return Column("time", "s", np.asarray(result.time))


def _columns(result: Any) -> Iterator[Column]:
    if isinstance(result, Numbered):
        for name in result.reported_measures:
            yield Column(name, result.expression(name).unit, result.values(name))
    elif isinstance(result, StructuralStates):
        table = measure_table(result)
        for name, unit, row in zip(
            table.index, table["unit"], table.iloc[:, 1:].to_numpy(float), strict=True
        ):
            yield Column(str(name), str(unit), row)
    else:
        for entry in measured_series(result, np.arange(result.time.size)):
            yield Column(entry["name"], entry["unit"], np.asarray(entry["values"]))


def _batch_table(batch: Batch) -> Table:
    designs = batch.designs
    varied: list[Column] = []
    common: list[Column] = []
    for name, unit, values in zip(designs.names, designs.units, designs.values.T, strict=True):
        (varied if name in designs.varied else common).append(Column(name, unit, values))
    coordinate = batch.coords[batch.sample_dimension]
    labels = coordinate[1] if isinstance(coordinate, tuple) else coordinate
    unit = "s" if batch.sample_dimension == "time" else ""
    statuses = "; ".join(f"{count} {o.value}" for o, count in batch.counts.items())
    return Table(
        Column(batch.sample_dimension, unit, np.asarray(labels)),
        list(_batch_columns(batch)),
        varied,
        [Column(c.name, c.unit, c.values[:1]) for c in common],
        {"model": batch.model.name, "status": statuses},
    )


def _batch_columns(batch: Batch) -> Iterator[Column]:
    """Scalar measures of all designs; some analyses do not have all of them."""
    for name in batch.model:
        if name in batch.model.parameters or name == batch.sample_dimension:
            continue
        try:
            expression = batch.expression(name)
            values = batch.values(expression) if len(expression) == 1 else None
        except DalembertError:
            continue
        if values is not None and not np.all(np.isnan(values)):
            yield Column(name, expression.unit, values)
