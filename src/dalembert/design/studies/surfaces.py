"""Surrogate models fitted to the designs of a study, with cross-validation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dalembert.design.studies.sweep_result import SweepResult
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.packages import optional_package
from dalembert.text.arguments import check_arguments


@dataclass(frozen=True, eq=False)
class Surface:
    """Surrogate model of a response, fitted to the designs of a study.

    Attributes
    ----------
    response, names : response and its parameters
    lower, upper : (k,) ranges of the fitted designs
    error : root mean square error in cross-validation
    determination : coefficient of determination in cross-validation, at most 1

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k = spring.parameter("k", 50.0)
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> grid = da.DesignTable.grid({"k": [1.0, 2.0, 3.0, 4.0, 5.0]})
    >>> response = da.final("3*k**2 + 1", name="y")
    >>> study = da.sweep(spring.build(), grid, analysis=da.Statics(), responses=response)
    >>> surface = da.response_surface(study, degree=2)
    >>> isinstance(surface, da.Surface), round(float(surface(k=2.5)), 6), round(surface.error, 9)
    (True, 19.75, 0.0)
    """

    response: str
    names: tuple[str, ...]
    lower: np.ndarray
    upper: np.ndarray
    error: float
    determination: float
    fitted: Any

    def __call__(self, **parameters: ArrayLike) -> float | np.ndarray:
        """Response at values of the parameters, numbers or arrays."""
        return self._predict(parameters)[0]

    def deviation(self, **parameters: ArrayLike) -> float | np.ndarray:
        """Standard deviation of a Gaussian process at values of the parameters."""
        return self._predict(parameters, return_std=True)[1]

    def _predict(
        self, parameters: Mapping[str, ArrayLike], **options: bool
    ) -> tuple[np.ndarray, ...]:
        if set(parameters) != set(self.names):
            raise AnalysisError(f"give values of {', '.join(self.names)}; got {set(parameters)}")
        columns = np.broadcast_arrays(*(np.asarray(parameters[n], dtype=float) for n in self.names))
        x = np.stack([column.ravel() for column in columns], axis=1)
        if not hasattr(self.fitted[-1], "kernel_") and options:
            raise UnsupportedError("only a Gaussian process has a deviation")
        prediction = self.fitted.predict((x - self.lower) / (self.upper - self.lower), **options)
        parts = prediction if isinstance(prediction, tuple) else (prediction,)
        return tuple(part.reshape(columns[0].shape)[()] for part in parts)


@check_arguments
def response_surface(study: SweepResult, response: str | None = None, degree: int = 2) -> Surface:
    """Polynomial response surface by least squares.

    Parameters
    ----------
    study : designs and their responses
    response : label; may be omitted if there is only one
    degree : of the polynomial

    Raises
    ------
    AnalysisError
        Fewer designs than the polynomial has terms.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> a, b = spring.parameter("a", 1.0), spring.parameter("b", 1.0)
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=a))
    >>> grid = da.DesignTable.grid({"a": [1.0, 2.0, 3.0], "b": [1.0, 2.0, 3.0]})
    >>> study = da.sweep(spring.build(), grid, analysis=da.Statics(), responses=da.final("a*b"))
    >>> plane = da.response_surface(study, degree=1)
    >>> round(float(plane(a=2.0, b=2.0)), 6), plane.determination < 1  # a plane has no curvature
    (4.0, True)
    """
    optional_package("sklearn", "a surface")
    from math import comb

    from sklearn.linear_model import LinearRegression
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import PolynomialFeatures

    terms = comb(len(study.design.names) + degree, degree)
    estimator = make_pipeline(PolynomialFeatures(degree), LinearRegression())
    return _fit_surface(study, response, estimator, terms)


@check_arguments
def gaussian_process(study: SweepResult, response: str | None = None, rng: int = 0) -> Surface:
    """Gaussian process with an anisotropic squared exponential kernel and noise.

    Source: C. E. Rasmussen, C. K. I. Williams, *Gaussian Processes for Machine Learning*, ch. 2.

    Parameters
    ----------
    study : designs and their responses
    response : label; may be omitted if there is only one
    rng : seed

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k = spring.parameter("k", 50.0)
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> grid = da.DesignTable.grid({"k": [0.5 * n for n in range(1, 12)]})
    >>> study = da.sweep(spring.build(), grid, analysis=da.Statics(), responses=da.final("sin(k)"))
    >>> process = da.gaussian_process(study)
    >>> round(float(process(k=1.25)), 2)  # sin 1.25 = 0.949
    0.95
    """
    optional_package("sklearn", "a surface")
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
    from sklearn.pipeline import make_pipeline

    lengths = np.ones(len(study.design.names))
    kernel = ConstantKernel(1.0, (1e-3, 1e6)) * RBF(lengths, (1e-2, 1e3)) + WhiteKernel(
        1e-6, (1e-12, 1e1)
    )
    process = GaussianProcessRegressor(
        kernel, normalize_y=True, random_state=rng, n_restarts_optimizer=4
    )
    return _fit_surface(study, response, make_pipeline(process), len(study.design.names) + 2)


def _fit_surface(
    study: SweepResult, response: str | None, estimator: Any, required: int
) -> Surface:
    import warnings

    from sklearn.base import clone
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.model_selection import KFold, cross_val_predict

    y = study.column(response)[study.success]
    x = study.design.values[study.success]
    if len(y) <= required:
        raise AnalysisError(f"{len(y)} designs are too few for this surface; give {required + 1}")
    lower, upper = x.min(axis=0), x.max(axis=0)
    if np.any(lower == upper):
        constant = study.design.names[int(np.argmax(lower == upper))]
        raise AnalysisError(f"{constant} does not vary in the study; leave it out")
    scaled = (x - lower) / (upper - lower)
    folds = KFold(min(10, len(y)), shuffle=True, random_state=0)
    with warnings.catch_warnings():  # a length scale at a bound is accepted
        warnings.simplefilter("ignore", ConvergenceWarning)
        fitted = estimator.fit(scaled, y)
    kernel = getattr(fitted[-1], "kernel_", None)
    fold_estimator = clone(estimator)
    if kernel is not None:  # all folds use the same length scales
        fold_estimator[-1].set_params(kernel=kernel, optimizer=None)
    predicted = cross_val_predict(fold_estimator, scaled, y, cv=folds)
    error = float(np.sqrt(np.mean((predicted - y) ** 2)))
    variance = float(np.var(y))
    determination = 1 - error**2 / variance if variance else 1.0
    name = response or study.responses[0]
    return Surface(name, study.design.names, lower, upper, error, determination, fitted)
