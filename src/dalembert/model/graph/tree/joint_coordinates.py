"""Joint coordinates as a choice of coordinates (6.2), (6.21)."""

from __future__ import annotations

from dalembert.elements.joint_forces import AlongJoint
from dalembert.errors import UnsupportedError
from dalembert.model.graph.coordinates import Coordinates
from dalembert.model.graph.model import Model
from dalembert.model.graph.tree.joint_view import JointView
from dalembert.options import options

CHOICES = {"angles": ("relative", "absolute"), "reactions": ("augmented", "projected")}


@options
class JointCoordinates(Coordinates):
    """Relative motions in the joints of a tree; loops are closed by constraints (6.21).

    Parameters
    ----------
    cut : names of joints to leave out of the tree; other loop joints are chosen automatically
    angles : of planar bodies, ``"relative"`` to the carrying body or ``"absolute"`` (Fig. 6.1)
    reactions : of the tree's joints, ``"augmented"`` by (7.13), without a matrix inversion, or
        ``"projected"`` by (6.3), (6.23)

    Raises
    ------
    UnsupportedError
        An unknown value of ``angles`` or ``reactions``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bar = system.add(planar.Bar("bar", length=1.5, mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bar.start))
    >>> relative = da.JointCoordinates()
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.01, coordinates=relative)
    >>> round(motion["position_violation"].max().item(), 12) + 0.0  # nothing can come apart
    0.0
    """

    cut: tuple[str, ...] = ()
    angles: str = "relative"
    reactions: str = "augmented"

    def __post_init__(self) -> None:
        names = (self.cut,) if isinstance(self.cut, str) else tuple(self.cut)
        object.__setattr__(self, "cut", names)
        for field, choices in CHOICES.items():
            value = getattr(self, field)
            if value not in choices:
                raise UnsupportedError(
                    f"JointCoordinates({field}={value!r}): choose {' or '.join(map(repr, choices))}"
                )

    def view(self, model: Model, every_equation: bool = False) -> JointView:
        elements = model.parts.elements.values()
        massive = [e.name for e in elements if e.own_mass and not isinstance(e, AlongJoint)]
        if massive:
            raise UnsupportedError(
                f"{', '.join(massive)}: mass between bodies has no tree of joints; use "
                "coordinates=AbsoluteCoordinates()"
            )
        absolute = self.angles == "absolute"
        return JointView(model, self.cut, absolute, self.reactions, every_equation)
