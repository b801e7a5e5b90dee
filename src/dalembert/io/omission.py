"""Parts that an import or an export could not convert."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Omission:
    """Part of a source that an imported model or an exported file does not contain.

    Attributes
    ----------
    place : element of the model, or file, line and element, ``arm.urdf:12: <transmission>``
    content : part, attribute or value that was not converted
    reason : why it was not converted, and the remedy where it matters

    Examples
    --------
    >>> import dalembert as da
    >>> omission = da.Omission("arm.urdf:12: <limit>", "effort", "forces are not limited")
    >>> print(omission)
    arm.urdf:12: <limit>: effort: forces are not limited
    """

    place: str
    content: str
    reason: str

    def __str__(self) -> str:
        return f"{self.place}: {self.content}: {self.reason}"
