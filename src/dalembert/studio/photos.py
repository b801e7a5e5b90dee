"""Photos under drawings, stored beside the unsaved drafts, by the path of the model file.

A file consists of a line of JSON, which states the place of the photo, and of the image as it was
chosen. It belongs to the model file whatever the address of the studio is.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import sys
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dalembert.errors import FileError
from dalembert.files import atomic_path
from dalembert.studio.journal import journal_folder

MAX_PHOTO = 30_000_000
"""Upper limit of the size of an image [bytes]."""
PLACE = ("x", "y", "scale", "opacity")
"""Numbers of the place: upper left corner [m], metres per pixel, opacity."""


@dataclass(frozen=True)
class Photo:
    """An image under a drawing.

    Attributes
    ----------
    place : numbers of ``PLACE``
    image : contents of the image file
    """

    place: dict[str, float]
    image: bytes


class Photos:
    """Photos of a user.

    Parameters
    ----------
    folder : of the drafts; that of the user by default
    """

    def __init__(self, folder: Path | None = None):
        self.folder = journal_folder() if folder is None else folder

    def read(self, name: str) -> Photo | None:
        """The photo of a model; None if there is none, or if it is damaged.

        Parameters
        ----------
        name : path of the model file, or the name of a new model
        """
        with suppress(OSError, ValueError):
            header, _, image = self.file(name).read_bytes().partition(b"\n")
            return Photo(place_of(header.decode()), image)
        return None

    def write(self, name: str, place: str, image: bytes) -> None:
        """Store the photo of a model.

        Parameters
        ----------
        name : as in ``read``
        place : JSON of its numbers
        image : contents of the image file

        Raises
        ------
        FileError
            The place is invalid, the image is too large, or the folder cannot be written.
        """
        if len(image) > MAX_PHOTO:
            raise FileError(
                f"the photo has more than {MAX_PHOTO / 1e6:.0f} MB; choose a smaller one"
            )
        try:
            header = json.dumps(place_of(place)).encode()
        except ValueError as error:
            raise FileError(f"the place of the photo is invalid: {error}") from None
        try:
            self.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        except OSError as error:
            raise FileError(f"{self.folder}: cannot be written ({error.strerror})") from None
        with atomic_path(self.file(name)) as temporary:
            temporary.write_bytes(header + b"\n" + image)

    def remove(self, name: str) -> None:
        """Delete the photo of a model, if there is one."""
        with suppress(OSError):
            self.file(name).unlink(missing_ok=True)

    def copy(self, name: str, to: str) -> None:
        """Give another model the photo of a model, such as one that is saved under a new name."""
        if self.file(name).is_file():
            with suppress(FileError), atomic_path(self.file(to)) as temporary:
                shutil.copyfile(self.file(name), temporary)

    def file(self, name: str) -> Path:
        """File of the photo of a model."""
        key = hashlib.sha256(name.encode("utf-8", "surrogatepass")).hexdigest()[:16]
        return self.folder / f"{key}.photo"


def place_of(text: str) -> dict[str, float]:
    """Numbers of a place from JSON.

    Raises
    ------
    ValueError
        They are missing or not finite, or the scale is not positive.
    """
    try:
        data: Any = json.loads(text)
    except RecursionError:
        raise ValueError("nested too deep") from None
    if not isinstance(data, dict):
        raise ValueError("no table of numbers")
    place: dict[str, Any] = {key: data.get(key) for key in PLACE}
    numbers = [
        isinstance(v, (int, float)) and not isinstance(v, bool) and abs(v) <= sys.float_info.max
        for v in place.values()
    ]
    if not all(numbers) or not place["scale"] > 0:
        raise ValueError(f"give the numbers {', '.join(PLACE)}")
    return {key: float(value) for key, value in place.items()}
