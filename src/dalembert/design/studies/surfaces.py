"""Surfaces through the designs of a study, and how far off they are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.design.studies.study import Study
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.text.spelling import spelled


@dataclass(frozen=True, eq=False)
class Surface:
    """A response as a function of parameters, fitted to the designs of a study.

    Attributes
    ----------
    response, names : what it gives, of which parameters
    lower, upper : (k,) ends of the designs that it was fitted to
    error : root mean square error at designs left out of the fit (cross-validation)
    determination : share of the variance that it explains there, 1 at best

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k = spring.parameter("k", 50.0)
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> grid = da.Design.grid({"k": [1.0, 2.0, 3.0, 4.0, 5.0]})
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

    def __call__(self, **parameters: Any) -> Any:
        """The response at values of the parameters, numbers or arrays."""
        return self._predicted(parameters)[0]

    def deviation(self, **parameters: Any) -> Any:
        """The standard deviation that a Gaussian process gives of itself there."""
        return self._predicted(parameters, return_std=True)[1]

    def _predicted(self, parameters: Mapping[str, Any], **how: Any) -> tuple[Any, ...]:
        if set(parameters) != set(self.names):
            raise AnalysisError(f"give values of {', '.join(self.names)}; got {set(parameters)}")
        sides = np.broadcast_arrays(*(np.asarray(parameters[n], dtype=float) for n in self.names))
        x = np.stack([side.ravel() for side in sides], axis=1)
        if not hasattr(self.fitted[-1], "kernel_") and how:
            raise UnsupportedError("only a Gaussian process tells its deviation")
        made = self.fitted.predict((x - self.lower) / (self.upper - self.lower), **how)
        parts = made if isinstance(made, tuple) else (made,)
        return tuple(part.reshape(sides[0].shape)[()] for part in parts)


@spelled
def response_surface(study: Study, response: str | None = None, degree: int = 2) -> Surface:
    """Polynomial of all parameters by least squares.

    Parameters
    ----------
    study : designs and their responses
    response : label; not needed where there is one only
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
    >>> grid = da.Design.grid({"a": [1.0, 2.0, 3.0], "b": [1.0, 2.0, 3.0]})
    >>> study = da.sweep(spring.build(), grid, analysis=da.Statics(), responses=da.final("a*b"))
    >>> plane = da.response_surface(study, degree=1)
    >>> round(float(plane(a=2.0, b=2.0)), 6), plane.determination < 1  # a plane does not bend
    (4.0, True)
    """
    _sklearn()
    from math import comb

    from sklearn.linear_model import LinearRegression
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import PolynomialFeatures

    terms = comb(len(study.design.names) + degree, degree)
    made = make_pipeline(PolynomialFeatures(degree), LinearRegression())
    return _surface(study, response, made, terms)


@spelled
def gaussian_process(study: Study, response: str | None = None, rng: int = 0) -> Surface:
    """Gaussian process with a squared exponential kernel, a length for each parameter, and noise.

    Source: C. E. Rasmussen, C. K. I. Williams, *Gaussian Processes for Machine Learning*, ch. 2.

    Parameters
    ----------
    study : designs and their responses
    response : label; not needed where there is one only
    rng : seed

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k = spring.parameter("k", 50.0)
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> grid = da.Design.grid({"k": [0.5 * n for n in range(1, 12)]})
    >>> study = da.sweep(spring.build(), grid, analysis=da.Statics(), responses=da.final("sin(k)"))
    >>> process = da.gaussian_process(study)
    >>> round(float(process(k=1.25)), 2)  # sin 1.25 = 0.949
    0.95
    """
    _sklearn()
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
    return _surface(study, response, make_pipeline(process), len(study.design.names) + 2)


def _surface(study: Study, response: str | None, estimator: Any, least: int) -> Surface:
    import warnings

    from sklearn.base import clone
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.model_selection import KFold, cross_val_predict

    y = study.column(response)[study.success]
    x = study.design.values[study.success]
    if len(y) <= least:
        raise AnalysisError(f"{len(y)} designs are too few for this surface; give {least + 1}")
    lower, upper = x.min(axis=0), x.max(axis=0)
    if np.any(lower == upper):
        same = study.design.names[int(np.argmax(lower == upper))]
        raise AnalysisError(f"{same} does not vary in the study; leave it out")
    scaled = (x - lower) / (upper - lower)
    folds = KFold(min(10, len(y)), shuffle=True, random_state=0)
    with warnings.catch_warnings():  # a length at the end of its range is no fault
        warnings.simplefilter("ignore", ConvergenceWarning)
        fitted = estimator.fit(scaled, y)
    kernel = getattr(fitted[-1], "kernel_", None)
    left = clone(estimator)
    if kernel is not None:  # lengths found once serve every fold
        left[-1].set_params(kernel=kernel, optimizer=None)
    left_out = cross_val_predict(left, scaled, y, cv=folds)
    error = float(np.sqrt(np.mean((left_out - y) ** 2)))
    spread = float(np.var(y))
    share = 1 - error**2 / spread if spread else 1.0
    name = response or study.responses[0]
    return Surface(name, study.design.names, lower, upper, error, share, fitted)


def _sklearn() -> None:
    try:
        import sklearn  # noqa: F401
    except ImportError:
        raise UnsupportedError(
            "surfaces need scikit-learn: pip install 'dalembert[study]'"
        ) from None
