"""Text of a model file, with its values and their places."""

from __future__ import annotations

import tomllib
from typing import Any

from dalembert.errors import ModelError
from dalembert.io.toml_places import Keys, Place, toml_places


class TomlText:
    """A valid TOML text.

    Parameters
    ----------
    text : valid TOML

    Attributes
    ----------
    text, data : the text and its contents

    Raises
    ------
    ModelError
        It is not valid.
    """

    def __init__(self, text: str):
        self.set_text(text)

    def set_text(self, text: str) -> None:
        """Replace the whole text, which is valid TOML."""
        try:
            self.data: dict[str, Any] = tomllib.loads(text)
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise ModelError(f"the text is not valid TOML ({error}); correct it first") from None
        self.text = text
        self._places: dict[Keys, Place] | None = None

    @property
    def places(self) -> dict[Keys, Place]:
        """Places of the entries in the text, located when they are first needed."""
        if self._places is None:
            self._places = toml_places(self.text)
        return self._places
