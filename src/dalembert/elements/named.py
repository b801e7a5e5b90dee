"""Points and frames by name."""

from __future__ import annotations

from typing import TypeVar

from dalembert.errors import UnknownNameError
from dalembert.text.wording import unknown

V = TypeVar("V")


class Named(dict[str, V]):
    """What an owner has under names; an unknown one is told with the nearest that there is.

    Parameters
    ----------
    owner : name of the owner
    what : what they are
    """

    def __init__(self, owner: str, what: str):
        super().__init__()
        self.owner, self.what = owner, what

    def __missing__(self, name: str) -> V:
        raise UnknownNameError(f"{self.owner}: {unknown(self.what, name, self)}", name)
