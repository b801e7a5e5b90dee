"""One-sided derivatives of simple and repeated eigenvalues."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.structural.eigenmodes import EigenModes, ModeWeights
from dalembert.sensitivity.structural.eigenpairs import PencilTangent
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    import xarray as xr


@check_arguments
def eigenvalue_slopes(
    modes: EigenModes, parameter: str, measure: str | None = None
) -> xr.DataArray:
    """One-sided derivatives of the eigenvalues of all modes for an increasing parameter.

    For coincident eigenvalues they are ``m'(λ)`` times the eigenvalues of ``Φᵀ (dA − λ dB) Φ``
    (Lancaster, Numerische Mathematik 6, 1964), in ascending order: the first of these modes
    decreases fastest. For a decreasing parameter the order is reversed.

    Parameters
    ----------
    modes : result of ``solve_modes`` or ``solve_buckling``
    parameter : name
    measure : function of eigenvalue and parameters; frequency or load factor by default

    Raises
    ------
    AnalysisError
        Unknown parameter; a measure that depends on shapes.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> cross = da.Structure("cross")
    >>> k = cross.parameter("k", 100.0)
    >>> hub = cross.node("hub", 0, 0)
    >>> part = cross.add(structures.GroundSpring("spring", hub, stiffness_x=k, stiffness_y=100.0))
    >>> mass = cross.add(structures.PointMass("mass", hub, mass=1.0))
    >>> modes = da.solve_modes(cross.build(), 2)  # both at 10 rad/s
    >>> slopes = da.eigenvalue_slopes(modes, "k", measure="eigenvalue")
    >>> slopes.values.round(6)  # one mode follows k/m
    array([0., 1.])
    """
    import xarray as xr

    names = list(modes.model.parameters)
    if parameter not in names:
        raise AnalysisError(
            f"unknown parameter {parameter!r} (known: {', '.join(names) or 'none'})"
        )
    expression = modes.expression(measure or modes.main)
    column = names.index(parameter)
    change = PencilTangent(modes.record.pencil).along(column)
    derivatives = np.zeros(modes.numbers.size)
    for group in modes.record.groups:
        phi = modes.record.shapes[:, group]
        da, db = change.of(phi)
        matrix = phi.T @ (da - db * modes.record.eigenvalues[group])
        rates = np.linalg.eigvalsh((matrix + matrix.T) / 2)
        members = [k for k, position in enumerate(modes.positions) if position in group]
        for k in members:
            weights = cast(ModeWeights, modes.weights(expression.sx, k))
            if weights.u.any():
                raise AnalysisError(
                    f"{expression.name or 'the measure'} depends on the shape; take one of "
                    f"{', '.join(modes.named)}"
                )
            slopes = np.sort(weights.eigenvalue * rates) + weights.p[column]
            derivatives[k] = slopes[group.index(int(modes.positions[k]))]
    unit = f"{expression.unit}/({modes.model.parameters[parameter].unit})".replace("/()", "")
    attrs = {"units": unit, "parameter": parameter}
    return xr.DataArray(derivatives, {"mode": modes.numbers}, ("mode",), expression.name, attrs)
