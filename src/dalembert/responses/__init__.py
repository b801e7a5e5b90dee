"""Responses: numbers drawn from a motion, each by one measure and one reduction."""

from dalembert.responses.base import Response, evaluate
from dalembert.responses.events import AtEvent, at_event, event_time
from dalembert.responses.extremes import Maximum, Minimum, maximum, minimum
from dalembert.responses.integrals import Integral, Mean, Rms, Total, integral, mean, rms, total
from dalembert.responses.values import At, Final, at, final

__all__ = [
    "At",
    "AtEvent",
    "Final",
    "Integral",
    "Maximum",
    "Mean",
    "Minimum",
    "Response",
    "Rms",
    "Total",
    "at",
    "at_event",
    "evaluate",
    "event_time",
    "final",
    "integral",
    "maximum",
    "mean",
    "minimum",
    "rms",
    "total",
]
