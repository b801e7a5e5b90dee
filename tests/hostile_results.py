"""Result files that read other files, block, or unpack to much more than they are."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

SECRET = b"the secret of the user, in another file"


def secret(path: Path) -> Path:
    other = path.parent / "secret.txt"
    other.write_bytes(SECRET)
    return other


def external_storage(path: Path) -> None:
    """The numbers of a dataset are the bytes of another file."""
    external = [(str(secret(path)), 0, len(SECRET))]
    with h5py.File(path, "w") as file:
        file.create_dataset("time", (len(SECRET),), "u1", external=external)


def external_pipe(path: Path) -> None:
    """Reading waits for a writer that never comes."""
    os.mkfifo(path.parent / "pipe")
    with h5py.File(path, "w") as file:
        external = [(str(path.parent / "pipe"), 0, 80)]
        file.create_dataset("time", (10,), "f8", external=external)


def external_link(path: Path) -> None:
    with h5py.File(path.parent / "other.h5", "w") as other:
        other["time"] = np.arange(3.0)
    with h5py.File(path, "w") as file:
        file["time"] = h5py.ExternalLink(str(path.parent / "other.h5"), "/time")


def external_link_to_pipe(path: Path) -> None:
    os.mkfifo(path.parent / "pipe")
    with h5py.File(path, "w") as file:
        file["time"] = h5py.ExternalLink(str(path.parent / "pipe"), "/time")


def virtual_dataset(path: Path) -> None:
    with h5py.File(path.parent / "other.h5", "w") as other:
        other["time"] = np.arange(3.0)
    layout = h5py.VirtualLayout((3,), "f8")
    layout[:] = h5py.VirtualSource(str(path.parent / "other.h5"), "time", (3,))
    with h5py.File(path, "w") as file:
        file.create_virtual_dataset("time", layout)


def soft_link(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_group("more")["numbers"] = np.arange(3.0)
        file["time"] = h5py.SoftLink("/more/numbers")


def cycle(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file["group"] = file["/"]
        file["time"] = h5py.SoftLink("/time")


def hard_links(path: Path) -> None:
    """One compressed array of 40 MB under 200 names."""
    with h5py.File(path, "w") as file:
        first = file.create_dataset("a0", (5_000_000,), "f8", chunks=(10**6,), compression="gzip")
        for k in range(1, 200):
            file[f"a{k}"] = first


def many_arrays(path: Path) -> None:
    """Two thousand compressed arrays of 8 MB, none of them large."""
    with h5py.File(path, "w", libver="latest") as file:
        for k in range(2000):
            chunks = {"chunks": (10**6,), "compression": "gzip"}
            file.create_dataset(f"a{k}", (10**6,), "f8", **chunks)


def one_array(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.create_dataset("time", (10**11,), "f8", chunks=(10**6,), compression="gzip")


HOSTILE: dict[str, Callable[[Path], None]] = {
    "external storage": external_storage,
    "external storage in a pipe": external_pipe,
    "external link": external_link,
    "external link to a pipe": external_link_to_pipe,
    "virtual dataset": virtual_dataset,
    "soft link": soft_link,
    "cycle": cycle,
    "hard links": hard_links,
    "many arrays": many_arrays,
    "one array": one_array,
}
