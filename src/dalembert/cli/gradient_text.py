"""Gradients as tables on the terminal and as a JSON document."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.cli.console import print_line, print_table
from dalembert.results.pictures.influence import by_influence, relative_influence

if TYPE_CHECKING:
    import xarray as xr

    from dalembert.sensitivity.checks.certificate import Certificate

MAX_ROWS = 30
"""Upper limit of parameters, or entries of a certificate, on the terminal; files contain all."""


def document(gradient: xr.DataArray) -> dict[str, Any]:
    """Values, gradients, influence, notes and certificate, for JSON."""
    relative = relative_influence(gradient)
    parameters = [str(p) for p in gradient["parameter"].values]

    def row(table: xr.DataArray, response: str) -> dict[str, float]:
        return dict(zip(parameters, table.sel(response=response).values.tolist(), strict=True))

    data: dict[str, Any] = {
        "method": gradient.attrs["method"],
        "parameters": {
            name: {
                key: gradient[coordinate].sel(parameter=name).item()
                for key, coordinate in (
                    ("value", "parameter_value"),
                    ("unit", "parameter_unit"),
                    ("lower", "lower"),
                    ("upper", "upper"),
                )
            }
            for name in parameters
        },
        "responses": {
            str(name): {
                "value": gradient["response_value"].sel(response=name).item(),
                "unit": str(gradient["response_unit"].sel(response=name).item()),
                "gradient": row(gradient, name),
                "relative": row(relative, name),
            }
            for name in gradient["response"].values
        },
        "by_influence": by_influence(gradient),
        "notes": gradient.attrs["notes"],
    }
    if "certificate" in gradient.attrs:
        data["certificate"] = _certificate_data(gradient.attrs["certificate"])
    return data


def _certificate_data(certificate: Certificate) -> dict[str, Any]:
    tests = certificate.data[["taylor_slope", "taylor_verdict"]].to_dataframe()
    return {
        "passed": certificate.passed,
        "entries": certificate.table().to_dict("records"),
        "taylor": tests.reset_index().to_dict("records"),
    }


def show(name: str, gradient: xr.DataArray) -> None:
    """Print tables, sorted by influence, and notes."""
    parameters = by_influence(gradient)
    ordered = gradient.sel(parameter=parameters[:MAX_ROWS])
    _print_table(f"{name}: derivatives by {gradient.attrs['method']}", ordered, _number)
    shares = relative_influence(gradient).sel(parameter=parameters[:MAX_ROWS])
    _print_table(f"{name}: percent of the response per percent of the parameter", shares, _share)
    if len(parameters) > MAX_ROWS:
        _print_indented(f"… and {len(parameters) - MAX_ROWS} more parameters; --output writes all")
    for note in gradient.attrs["notes"]:
        _print_indented(f"note: {note}", "yellow")
    if "certificate" in gradient.attrs:
        _show_certificate(gradient.attrs["certificate"])


def _print_table(title: str, table: xr.DataArray, format_entry: Any) -> None:
    """Print a table with parameters as rows if there are at least as many as responses."""
    parameters_as_rows = table.sizes["parameter"] >= table.sizes["response"]
    rows, columns = ("parameter", "response") if parameters_as_rows else ("response", "parameter")
    table = table.transpose(rows, columns)
    column_heads = [_head(table.isel({columns: k}), columns) for k in range(table.sizes[columns])]
    lines = [
        [*_head(table.isel({rows: k}), rows), *(format_entry(x) for x in line)]
        for k, line in enumerate(table.values)
    ]
    headings = [rows, "value", *("\n".join(part for part in head if part) for head in column_heads)]
    print_table(headings, lines, title, columns_touch=False)


def _head(entry: xr.DataArray, dimension: str) -> tuple[str, str]:
    """Name, and value with unit, of a parameter or response."""
    value = f"{float(entry[f'{dimension}_value']):.6g} {entry[f'{dimension}_unit'].item()}"
    return str(entry[dimension].item()), value.rstrip()


def _number(value: float) -> str:
    return "0" if value == 0 else f"{value:.6g}"


def _share(value: float) -> str:
    if np.isnan(value):
        return "–"
    return "0" if abs(value) < 5e-13 else f"{value:+.4g}"


def _show_certificate(certificate: Certificate) -> None:
    table = certificate.table().sort_values("error", ascending=False)
    lines = [
        [
            f"d {row.response} / d {row.parameter}",
            f"{row.adjoint:.9g}",
            f"{row.disagreement:.0e}",
            f"{row.difference:.9g}",
            f"{row.step:.1e}",
            f"{row.error:.0e}",
            row.verdict,
        ]
        for row in table.head(MAX_ROWS).itertuples()
    ]
    headings = ["certificate", "adjoint", "− direct", "difference", "step", "error", "verdict"]
    print_table(headings, lines, columns_touch=False)
    if len(table) > MAX_ROWS:
        _print_indented(f"… and {len(table) - MAX_ROWS} more entries, with smaller errors")
    for line in certificate.summary():
        _print_indented(line, "green" if certificate.passed else "red")


def _print_indented(text: str, style: str | None = None) -> None:
    print_line(f"  {text}", style)
