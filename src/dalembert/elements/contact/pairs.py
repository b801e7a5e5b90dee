"""Laws of contact between groups of shapes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.elements.base import Condition, Scalar, option, quantity
from dalembert.elements.component import Component
from dalembert.elements.contact.laws import NormalLaw, Restitution
from dalembert.elements.contact.unilateral import at_most_one
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import unknown

COEFFICIENTS = (
    "restitution",
    "tangential",
    "impact_law",
    "static_friction",
    "friction",
    "rolling",
    "spinning",
)
"""Coefficients of a law, in the order of the columns of ``Collisions.coefficients``; the
law of impact counts as its number."""
RETURNS = "restitution", "tangential"
"""Coefficients of rigid contacts only."""
APART = -1
"""Law number of shapes that pass through each other."""
EXAMPLE = "contact.HuntCrossley(stiffness=1e6, damping=0.1)"


@dataclass(eq=False)
class Pair(Component):
    """Restitution and friction between two groups of shapes of ``Collisions``.

    Parameters
    ----------
    groups : names of two groups; the same name twice for shapes of one group
    restitution, tangential, friction, rolling, spinning : those of ``Collisions`` by default
    static_friction : by default ``friction`` of this pair, if it has one
    impact_law : meaning of ``restitution``, that of ``Collisions`` by default
    law : normal force law, or ``contact.Restitution(…)`` for rigid contacts; that of ``Collisions``
        by default
    touching : False if shapes of these groups pass through each other, without coefficients or law

    Raises
    ------
    ModelError
        Not two names; coefficients or a law of shapes that do not touch each other.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("two pucks")
    >>> fast = planar.Particle("fast", mass=1.0, position=(0, 0), velocity=(1, 0))
    >>> slow = planar.Particle("slow", mass=1.0, position=(0.3, 0))
    >>> steel, rubber = (contact.Circle(system.add(puck), 0.1) for puck in (fast, slow))
    >>> pair = contact.Pair(("steel", "rubber"), restitution=0.5)
    >>> shapes = {"steel": [steel], "rubber": [rubber]}
    >>> hits = system.add(planar.Collisions("hits", shapes, pairs=[pair]))
    >>> motion = da.solve_nonsmooth(system.build(), 0.3, step=0.01)
    >>> motion["slow.vx"][-1].round(9).item()  # (1 + e)/2
    0.75
    """

    groups: tuple[str, ...] = option("names of two groups, or one name twice")
    restitution: Scalar = quantity("", "restitution along the normal", default=None, minimum=0.0)
    tangential: Scalar = quantity("", "restitution of the slip", default=None, minimum=0.0)
    friction: Scalar = quantity("", "coefficient of friction", default=None, minimum=0.0)
    rolling: Scalar = quantity("m", "coefficient of rolling friction", default=None, minimum=0.0)
    spinning: Scalar = quantity("m", "coefficient of spinning friction", default=None, minimum=0.0)
    static_friction: Scalar = quantity(
        "", "coefficient of friction without slip", default=None, minimum=0.0
    )
    impact_law: str | None = option("`newton`, `poisson` or `energetic`", default=None)
    law: NormalLaw | Restitution | None = option(
        "normal force law, or restitution of rigid contacts", default=None
    )
    touching: bool = option("whether shapes of these groups touch each other", default=True)

    def __post_init__(self) -> None:
        groups = self.groups
        texts = isinstance(groups, (list, tuple)) and all(isinstance(g, str) for g in groups)
        if not texts or len(groups) != 2:
            raise ModelError(
                f"groups is {groups!r:.60}; give two names of groups, such as ('discs', 'walls')",
                "Pair",
            )
        self.groups = tuple(groups)
        if not isinstance(self.touching, bool):
            raise ModelError(f"touching is {self.touching!r}; give True or False", "Pair")
        specified = [name for name in (*COEFFICIENTS, "law") if self._specifies(name)]
        if specified and not self.touching:
            raise ModelError(
                f"shapes of groups with touching=False have no {specified[0]}; leave it out",
                "Pair",
            )
        super().__post_init__()
        check_law("Pair", self.law, [name for name in RETURNS if self._specifies(name)])

    def _specifies(self, name: str) -> bool:
        """Whether a coefficient or law differs from that of ``Collisions``."""
        return getattr(self, name) is not None

    def conditions(self) -> list[Condition]:
        coefficients = {"restitution": self.restitution, "tangential": self.tangential}
        return [at_most_one(e.sx, name) for name, e in coefficients.items() if e is not None]

    def completed(self, defaults: Mapping[str, Any]) -> dict[str, Any]:
        """The coefficients by their names, with defaults where it has none."""
        own: dict[str, Any] = {name: getattr(self, name) for name in COEFFICIENTS}
        own |= returns(self.law)
        if own["static_friction"] is None:
            own["static_friction"] = self.friction
        return {name: defaults[name] if c is None else c for name, c in own.items()}


def check_law(entity: str, law: object, rigid: list[str]) -> None:
    """Check the law of shapes.

    Parameters
    ----------
    rigid : coefficients of rigid contacts that stand beside the law

    Raises
    ------
    ModelError
        Another object, or a law beside other coefficients of restitution.
    """
    if law is None:
        return
    if not isinstance(law, (NormalLaw, Restitution)):
        raise ModelError(f"is {law!r:.60}; give a law such as {EXAMPLE}", f"{entity}.law")
    if rigid:
        kind = type(law).__name__
        text = f"{rigid[0]} and law={kind}(…) are both present; the law has its own restitution"
        raise ModelError(f"{text}, so leave out one of them", f"{entity}.{rigid[0]}")


def returns(law: NormalLaw | Restitution | None) -> dict[str, Scalar]:
    """Coefficients of restitution in a law, zero in a force law; empty without a law."""
    if isinstance(law, Restitution):
        return {"restitution": law.e, "tangential": law.tangential}
    return {} if law is None else dict.fromkeys(RETURNS, Expression(0.0))


def checked_pairs(pairs: Pair | Iterable[Pair], groups: list[str], owner: str) -> tuple[Pair, ...]:
    """Pairs of known groups.

    Raises
    ------
    ModelError
        Another object, an unknown group, or two pairs of the same groups.
    """
    listed = (pairs,) if isinstance(pairs, Pair) else tuple(pairs)
    names, pairs_of_groups = [group for group in groups if group], set()
    for k, pair in enumerate(listed):
        entity = f"{owner}.pairs[{k}]"
        if not isinstance(pair, Pair):
            example = "contact.Pair(('discs', 'walls'), friction=0.3)"
            raise ModelError(f"is {pair!r:.60}; give pairs such as {example}", entity)
        for group in pair.groups:
            if group not in names:
                text = f"there is no group {group!r}; give shapes={{{group!r}: […], …}}"
                raise ModelError(unknown("group", group, names) if names else text, entity)
        if frozenset(pair.groups) in pairs_of_groups:
            both = " and ".join(pair.groups)
            raise ModelError(f"{both} have another pair; give one pair of two groups", entity)
        pairs_of_groups.add(frozenset(pair.groups))
    return listed


def law_numbers(groups: list[str], pairs: tuple[Pair, ...]) -> np.ndarray:
    """(groups, groups) numbers of the laws: 0 by default, k + 1 of pair k, or ``APART``."""
    table = np.zeros((len(groups), len(groups)), dtype=int)
    for k, pair in enumerate(pairs):
        i, j = (groups.index(group) for group in pair.groups)
        table[i, j] = table[j, i] = k + 1 if pair.touching else APART
    return table


def force_laws(
    law: NormalLaw | Restitution | None, pairs: tuple[Pair, ...], owner: str
) -> tuple[NormalLaw | None, ...]:
    """Force laws of shapes in the order of the law numbers; None for rigid contacts.

    Raises
    ------
    ModelError
        A pair has a restitution beside the force law of ``owner``.
    """
    laws = [law, *(law if pair.law is None else pair.law for pair in pairs)]
    force = tuple(each if isinstance(each, NormalLaw) else None for each in laws)
    for k, pair in enumerate(pairs):
        rigid = [name for name in RETURNS if getattr(pair, name) is not None]
        if rigid and force[k + 1]:
            text = f"has no effect beside law={type(law).__name__}(…) of {owner}; give this pair "
            raise ModelError(text + "law=contact.Restitution(…)", f"{owner}.pairs[{k}].{rigid[0]}")
    return force
