"""Models with a rigid contact for each pair of shapes, whose impacts are located."""

from __future__ import annotations

from dalembert.elements.contact.collisions import Collisions
from dalembert.errors import UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.symbolic.once import once

MOST_GAPS = 200
"""Upper limit of the gaps among many shapes whose impacts are located."""


def collisions_of(model: Model) -> list[Collisions]:
    """Elements with gaps among many shapes."""
    return [e for e in model.parts.elements.values() if isinstance(e, Collisions)]


@once
def with_located_pairs(model: Model) -> Model:
    """The model with contacts of all pairs of shapes; the model itself if there are none.

    Raises
    ------
    UnsupportedError
        Too many pairs, or pairs without located impacts.
    """
    elements = collisions_of(model)
    if not elements:
        return model
    from dalembert.elements.contact.pair_contact import pair_contacts

    contacts = [contact for element in elements for contact in pair_contacts(element)]
    count = sum(len(contact.contact_points) for contact in contacts)
    if count > MOST_GAPS:
        names = ", ".join(element.name for element in elements)
        raise UnsupportedError(
            f"{names}: there are {count} gaps among all shapes, and the impacts of at most "
            f"{MOST_GAPS} are located; use solve_nonsmooth, or keep groups apart with "
            "contact.Pair(…, touching=False)"
        )
    return Model.assembled(model.parts.with_elements(contacts))
