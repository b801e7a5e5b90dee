"""Names of the components of what is measured."""

from __future__ import annotations

COMPONENTS = {
    2: ("axis", ("x", "y")),
    3: ("axis", ("x", "y", "z")),
    4: ("component", ("e0", "e1", "e2", "e3")),
    9: ("entry", tuple(f"{row}{column}" for row in "xyz" for column in "xyz")),
}
"""Dimension and names of so many components: vectors, Euler parameters, matrices by rows."""
