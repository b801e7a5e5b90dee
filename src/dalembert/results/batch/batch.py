"""Results of one analysis for many designs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import AnalysisError, ExpressionError
from dalembert.results.analysis import Analysis
from dalembert.results.batch.designs import Designs
from dalembert.results.batch.samples import Samples, complex_amplitudes
from dalembert.results.files.contents import COMPONENTS
from dalembert.results.result import REMEDIES, Result, missing_name
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.parametric_model import ParametricModel

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

OF_ONE_DESIGN = (
    "batch[k] returns the result of one design, with its report and pictures, batch['measure'] "
    "the values of all designs"
)
UNITS = {"time": "s", "frequency": "Hz"}
"""Units of the samples of a design."""


def _never(measure: str | Expression) -> bool:
    return False


@dataclass(eq=False, repr=False)
class Batch:
    """Results of one analysis for many designs of one model.

    Failed designs are marked in ``status`` and raise no error. Values that they do not reach are
    NaN.

    Attributes
    ----------
    model : model of all designs
    analysis : analysis that computed it
    designs : Designs, the values of the parameters
    statuses : Status of each design
    samples : stored measures of the designs
    results : number of the design → its result, for designs stored as a whole
    statistics : name → number or text
    warnings : reservations about the chosen methods

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("scale", gravity=(0, -10))
    >>> k = system.parameter("k", 100.0)
    >>> pan = system.add(planar.Particle("pan", mass=2.0, position=(0, -0.1)))
    >>> spring = system.add(planar.Spring("spring", system.ground.center, pan.center, stiffness=k))
    >>> many = da.solve_equilibrium(system.build(), parameters={"k": [50.0, 100.0, 200.0]})
    >>> isinstance(many, da.Batch), many["pan.y"].values.ravel().round(6)  # -m g/k
    (True, array([-0.4, -0.2, -0.1]))
    """

    model: ParametricModel
    analysis: Analysis
    designs: Designs
    statuses: list[Status]
    samples: Samples
    results: Mapping[int, Result] = field(default_factory=dict)
    statistics: dict[str, Any] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            of_results = name in REMEDIES or hasattr(Result, name)
            raise missing_name(self, name, OF_ONE_DESIGN if of_results else "", OF_ONE_DESIGN)

    def __len__(self) -> int:
        return len(self.statuses)

    @property
    def time(self) -> np.ndarray:
        """(K,) output times [s], or numbers of load cases."""
        return self.samples.time

    # outcomes ----------------------------------------------------------------------
    @cached_property
    def succeeded(self) -> np.ndarray:
        """(designs,) whether each design succeeded."""
        return np.array([status.success for status in self.statuses])

    @property
    def status(self) -> xr.DataArray:
        """Outcome of each design, with its message, last time and residual as coordinates."""
        import xarray as xr

        attributes = {
            "message": ("design", [s.message for s in self.statuses]),
            "time_reached": ("design", [s.time for s in self.statuses], {"units": "s"}),
            "residual": ("design", [s.residual for s in self.statuses]),
            "outcome": ("design", [s.outcome.name for s in self.statuses]),
        }
        outcomes = [s.outcome.value for s in self.statuses]
        return xr.DataArray(outcomes, self.designs.coords | attributes, ("design",), "status")

    @property
    def table(self) -> pd.DataFrame:
        """A row per design: its varied parameters and its status."""
        status = self.status
        return status.to_dataframe().drop(columns=["time_reached"], errors="ignore")

    @property
    def counts(self) -> dict[Outcome, int]:
        """Outcome → number of designs, the most frequent first."""
        outcomes = [status.outcome for status in self.statuses]
        return dict(
            sorted(((o, outcomes.count(o)) for o in set(outcomes)), key=lambda pair: -pair[1])
        )

    # measures ----------------------------------------------------------------------
    def expression(self, measure: str | Expression) -> Expression:
        """A measure by name, a formula or an expression."""
        return self.analysis.expression(self.model, measure)

    def values(self, measure: str | Expression) -> np.ndarray:
        """(designs, K) or (designs, K, size) values of a measure."""
        table = self.samples.table([self.expression(measure)])
        return table[:, 0] if table.shape[1] == 1 else table.transpose(0, 2, 1)

    def __getitem__(self, key: str | Expression | int) -> Any:
        """A measure or formula of all designs over time, or one design by its number.

        Raises
        ------
        KeyError
            Unknown name; suggests the nearest ones.
        """
        if isinstance(key, (int, np.integer)):
            return self.design(int(key))
        return complex_amplitudes(self, key) if self._is_complex(key) else self.labelled(key)

    def _is_complex(self, measure: str | Expression) -> bool:
        """Whether a measure of harmonic responses has complex amplitudes."""
        first_result = next(iter(self.results.values()), None)
        return bool(getattr(first_result, "is_complex", _never)(measure))

    def __contains__(self, key: object) -> bool:
        """Whether a measure or formula exists, or a design of this number."""
        if isinstance(key, (int, np.integer)):
            return -len(self) <= int(key) < len(self)
        if not isinstance(key, (str, Expression)):
            return False
        try:
            self.expression(key)
        except ExpressionError:
            return False
        return True

    def labelled(self, measure: str | Expression) -> xr.DataArray:
        """Values of a measure, labelled by design and time."""
        import xarray as xr

        expression = self.expression(measure)
        name = expression.name or (measure if isinstance(measure, str) else "measure")
        coords = self.coords
        dims = ["design", self.sample_dimension]
        if len(expression) > 1:
            dimension, components = COMPONENTS[len(expression)]
            coords[dimension] = list(components)
            dims.append(dimension)
        attributes = {"units": expression.unit, "long_name": name}
        return xr.DataArray(self.values(expression), coords, dims, name, attributes)

    @property
    def sample_dimension(self) -> str:
        """Dimension of the samples of a design."""
        first_result = next(iter(self.results.values()), None)
        usual = "case" if hasattr(first_result, "cases") else "time"
        return getattr(first_result, "sample_dimension", usual)

    @property
    def coords(self) -> dict[str, Any]:
        """Coordinates of designs and instants."""
        first_result = next(iter(self.results.values()), None)
        cases = getattr(first_result, "cases", None)
        dimension = self.sample_dimension
        instants = (
            (dimension, self.time, {"units": UNITS[dimension]})
            if cases is None
            else ("case", cases)
        )
        return {**self.designs.coords, dimension: instants}

    def design(self, k: int) -> Any:
        """Full result of one design, from a new run.

        Raises
        ------
        AnalysisError
            Unknown design, or a design that could not start.
        """
        if not -len(self) <= k < len(self):
            raise AnalysisError(f"design {k} of a batch of {len(self)}; they count from 0")
        return self.analysis.run(self.model, self.designs.named(k % len(self)))

    def __iter__(self) -> Iterator[Any]:
        """Results of the designs that could start."""
        refused = (Outcome.NOT_ASSEMBLED, Outcome.REFUSED)
        for k, status in enumerate(self.statuses):
            if status.outcome not in refused:
                yield self.design(k)

    # output -------------------------------------------------------------------------
    @cached_property
    def data(self) -> xr.Dataset:
        """Labelled dataset as of one result, with the status of each design."""
        from dalembert.results.batch.samples import batch_dataset

        return batch_dataset(self)

    def select(self, *measures: str | Expression) -> xr.Dataset:
        """Dataset of some measures, with the status of each design."""
        import xarray as xr

        arrays = {}
        for measure in measures:
            array = self.labelled(measure)
            arrays[str(array.name)] = array
        return xr.Dataset({"status": self.status, **arrays}, attrs=self.attributes)

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of the dataset."""
        fixed = {
            f"parameter_{name}": float(self.designs.values[0, i])
            for i, name in enumerate(self.designs.names)
            if name not in self.designs.varied
        }
        warnings = "\n".join(self.warnings)
        attributes = {
            "model": self.model.name,
            "analysis": repr(self.analysis),
            "warnings": warnings,
        }
        return attributes | fixed

    def save(self, path: str | Path, *measures: str | Expression) -> Path:
        """Write all or some measures to a NetCDF file; ``load_results`` reads it back."""
        from dalembert.results.files.store import save_dataset

        return save_dataset(self.select(*measures) if measures else self.data, path)

    def to_dataframe(self, *measures: str | Expression) -> pd.DataFrame:
        """A row per design and instant of some measures; without any, a row per design."""
        if not measures:
            return self.table
        return self.select(*measures).drop_vars(["message", "time_reached"]).to_dataframe()

    def to_csv(self, path: str | Path, *measures: str | Expression) -> Path:
        """Write ``to_dataframe`` as CSV."""
        from dalembert.results.files.store import save_table

        return save_table(self.to_dataframe(*measures), path)

    def summary(self) -> dict[str, Any]:
        """Number of designs per outcome, and the statistics."""
        return {
            "designs": len(self),
            "outcomes": {outcome.value: count for outcome, count in self.counts.items()},
            "statistics": self.statistics,
            "warnings": list(self.warnings),
        }

    def __repr__(self) -> str:
        varied = ", ".join(self.designs.varied) or "nothing"
        outcomes = ", ".join(f"{count} {o.value}" for o, count in self.counts.items())
        return f"<Batch of {self.model.name!r}: {len(self)} designs of {varied}; {outcomes}>"

    def _repr_html_(self) -> str:
        from html import escape

        table = self.table.drop(columns=["message"])
        head = table if len(table) <= 10 else table.iloc[:10]
        return f"<p>{escape(repr(self))}</p>{head.to_html()}"
