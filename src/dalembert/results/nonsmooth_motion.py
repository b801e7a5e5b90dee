"""Motion with impacts: beside what every motion has, the impulses of contacts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.contact_record import ContactRecord
from dalembert.results.files.contents import Contents
from dalembert.results.motion import Motion

if TYPE_CHECKING:
    import xarray as xr


@dataclass(eq=False, repr=False)
class NonsmoothMotion(Motion):
    """Motion of a mechanism with rigid contacts.

    ``data`` has, since the output before, ``normal_impulse`` and ``friction_impulse`` of every
    element with gaps (sums of magnitudes), and at each output ``penetration``.
    """

    @cached_property
    def contents(self) -> Contents:
        from dalembert.results.dataset import motion_contents

        record: ContactRecord = self.record
        normal = record.summed(self.time, record.impulse[:, 0])
        friction = record.summed(self.time, np.linalg.norm(record.impulse[:, 1:], axis=1))
        depth = np.interp(self.time, record.t, record.penetration)
        along = ("time", "contact")
        more = {
            "normal_impulse": (along, normal, _told("normal impulses", "N s")),
            "friction_impulse": (along, friction, _told("friction impulses", "N s")),
            "penetration": ("time", depth, _told("depth of the deepest gap", "m")),
        }
        return motion_contents(self).plus(more, {"contact": list(record.names)})

    def impulse(self, name: str) -> xr.DataArray:
        """(K,) sum of the normal impulses of an element since the output before [N s].

        Raises
        ------
        AnalysisError
            No element with gaps has this name.
        """
        known = list(self.record.names)
        if name not in known:
            text = f"no element with gaps is called {name!r} (known: {', '.join(known)})"
            raise AnalysisError(text)
        return self.data["normal_impulse"].sel(contact=name)


def _told(name: str, unit: str) -> dict[str, str]:
    return {"long_name": name, "units": unit}
