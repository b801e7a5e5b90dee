"""Motion laws ``f(t)`` for drivers."""

from dalembert.elements.laws.base import Formula, Harmonic, Law, Polynomial, Product, Sum
from dalembert.elements.laws.rise import (
    CycloidalRise,
    HarmonicRise,
    Polynomial345Rise,
    Polynomial4567Rise,
)
from dalembert.elements.laws.table import Table

__all__ = [
    "CycloidalRise",
    "Formula",
    "Harmonic",
    "HarmonicRise",
    "Law",
    "Polynomial",
    "Polynomial345Rise",
    "Polynomial4567Rise",
    "Product",
    "Sum",
    "Table",
]
