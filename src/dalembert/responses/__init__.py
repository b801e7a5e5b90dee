"""Responses: numbers drawn from a motion, each by one measure and one reduction."""

from dalembert.responses.base import Response, evaluate
from dalembert.responses.extremes import Maximum, Minimum, maximum, minimum
from dalembert.responses.integrals import Integral, Mean, Rms, integral, mean, rms
from dalembert.responses.values import At, Final, at, final

__all__ = [
    "At",
    "Final",
    "Integral",
    "Maximum",
    "Mean",
    "Minimum",
    "Response",
    "Rms",
    "at",
    "evaluate",
    "final",
    "integral",
    "maximum",
    "mean",
    "minimum",
    "rms",
]
