"""Motion with impacts, and its record of contact impulses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.options import is_number
from dalembert.results.contact_forces import ContactForces
from dalembert.results.files.contents import Contents
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class ContactRecord:
    """Contact impulses, losses and residuals of K steps.

    Attributes
    ----------
    ends : Trajectory of K+1 states, at the start and at the end of each step; accelerations and
        multipliers are means over the step before, at the start over the first
    names : elements that have gaps
    step, owner, key : (c,) step, element and gap of each impulse
    impulse : (c, k) [N s], the normal component first, those of rotations last [N m s]
    offset : (c, k) velocity offset of the condition at the end of the step [m/s]
    curved : (c,) whether the velocities are means over the path of the step, as for concave gaps
    kept : (c,) whether the directions are those at the start of the step, as for impacts
    paths : (K,) solutions of each step before the last one, on whose paths gaps have means
    impacts : (K,) impacts at the start of each step, by other laws than Newton's; None without any
    longest : (K,) longest step that might follow, for which gaps leave room [s]
    linear : number of components that are not rotations
    loss : (K,) energy dissipated by contacts [J]
    work : (c,) work of the normal force of a compliant contact, zero for a rigid one [J]
    fraction : (c,) length of the step over the duration of a compliant contact, else zero [-]
    stored : (K+1,) elastic energy of compliant contacts [J]
    compression : (K+1,) maximum penetration of compliant contacts [m]
    penetration : (K+1,) maximum penetration of rigid gaps [m]
    residual : (K,) of the contact conditions, as a speed [m/s]
    rounds : (K,) iterations of the proximal method
    converged : (K,) whether the residual is within the tolerance of the solver
    accuracy : error estimate of the run, computed when it is read
    """

    ends: Trajectory
    names: tuple[str, ...]
    step: np.ndarray
    owner: np.ndarray
    key: np.ndarray
    impulse: np.ndarray
    offset: np.ndarray
    curved: np.ndarray
    kept: np.ndarray
    paths: Sequence[Any]
    impacts: Sequence[Any]
    longest: np.ndarray
    linear: int
    loss: np.ndarray
    work: np.ndarray
    fraction: np.ndarray
    stored: np.ndarray
    compression: np.ndarray
    penetration: np.ndarray
    residual: np.ndarray
    rounds: np.ndarray
    converged: np.ndarray
    accuracy: Any = None

    @property
    def t(self) -> np.ndarray:
        """(K+1,) ends of the steps [s]."""
        return self.ends.t

    @property
    def pressing(self) -> np.ndarray:
        """(K,) number of active contacts."""
        return np.bincount(self.step, minlength=self.loss.size)

    def summed(self, times: np.ndarray, values: np.ndarray) -> np.ndarray:
        """(times, elements) sums of a value per impulse since the previous time."""
        sums = np.zeros((times.size, len(self.names)))
        slack = 1e-12 * max(abs(self.t[0]), abs(self.t[-1]))
        row = np.searchsorted(times, self.t[self.step + 1] - slack)
        inside = row < times.size
        np.add.at(sums, (row[inside], self.owner[inside]), values[inside])
        return sums


@dataclass(eq=False, repr=False)
class NonsmoothMotion(Motion):
    """Motion of a mechanism with contacts.

    ``data`` has, since the previous output, ``normal_impulse`` and ``friction_impulse`` of every
    element with gaps (sums of magnitudes), and at each output ``penetration`` of rigid contacts
    and, of compliant ones, the largest penetration ``compression`` and the elastic energy
    ``contact_energy``, which is part of the ``potential_energy``.
    """

    @cached_property
    def contents(self) -> Contents:
        from dalembert.results.dataset import motion_contents

        record: ContactRecord = self.record
        normal = record.summed(self.time, record.impulse[:, 0])
        sliding = np.linalg.norm(record.impulse[:, 1 : record.linear], axis=1)
        friction = record.summed(self.time, sliding)
        depth = np.interp(self.time, record.t, record.penetration)
        pressed = np.interp(self.time, record.t, record.compression)
        dims = ("time", "contact")
        variables = {
            "normal_impulse": (dims, normal, _attributes("normal impulses", "N s")),
            "friction_impulse": (dims, friction, _attributes("friction impulses", "N s")),
            "penetration": ("time", depth, _attributes("depth of the deepest rigid gap", "m")),
            "compression": ("time", pressed, _attributes("largest compliant penetration", "m")),
        }
        contents = motion_contents(self)
        stored = np.interp(self.time, record.t, record.stored)
        variables["contact_energy"] = ("time", stored, _attributes("energy of contacts", "J"))
        for name in ("potential_energy", "energy", "balance_error") if stored.any() else ():
            start = stored[:1] if name == "balance_error" else 0.0
            values = contents[name] + stored - start
            variables[name] = ("time", values, contents.attributes_of(name))
        return contents.plus(variables, {"contact": list(record.names)})

    def impulse(self, name: str) -> xr.DataArray:
        """(K,) sum of the normal impulses of an element since the previous output [N s].

        Raises
        ------
        AnalysisError
            No element with gaps has this name.
        """
        names = list(self.record.names)
        if name not in names:
            text = f"no element with gaps is called {name!r} (known: {', '.join(names)})"
            raise AnalysisError(text)
        return self.data["normal_impulse"].sel(contact=name)

    def contact_forces(self, time: float) -> ContactForces:
        """Positions, forces and bodies of all contacts at the output nearest to a time.

        Parameters
        ----------
        time : within the run [s]; the first output has no step before it and no contacts

        Raises
        ------
        AnalysisError
            The time is not within the run.

        Examples
        --------
        >>> import dalembert as da
        >>> from dalembert import planar
        >>> system = da.System("crate", gravity=(0, -10))
        >>> crate = planar.Body("crate", mass=2.0, inertia=0.1, position=(0, 0.1))
        >>> shapes = [planar.contact.Rectangle(system.add(crate), (0.4, 0.2)),
        ...     planar.contact.HalfPlane(system.ground)]
        >>> floor = system.add(planar.Collisions("floor", shapes))
        >>> motion = da.solve_nonsmooth(system.build(), 0.1, step=0.01)
        >>> contacts = motion.contact_forces(0.1)
        >>> contacts.places.round(6).tolist(), contacts.forces[:, 1].round(6).tolist()
        ([[-0.2, 0.0], [0.2, 0.0]], [10.0, 10.0])
        >>> contacts.bodies[0].tolist(), contacts.between("ground", "crate").round(6).tolist()
        (['ground', 'crate'], [0.0, 20.0])
        """
        first, last = float(self.time[0]), float(self.time[-1])
        slack = 1e-9 * (last - first)
        if not is_number(time) or not first - slack <= time <= last + slack:
            text = f"{time:g} s" if is_number(time) else repr(time)
            raise AnalysisError(f"time is {text}; give a number from {first:g} to {last:g} s")
        return self.drawn_contacts(int(np.argmin(np.abs(self.time - time))))

    def drawn_contacts(self, row: int) -> ContactForces:
        analysis: Any = self.analysis
        forces: ContactForces = analysis.contact_forces(self, row)
        return forces


def _attributes(name: str, unit: str) -> dict[str, str]:
    return {"long_name": name, "units": unit}
