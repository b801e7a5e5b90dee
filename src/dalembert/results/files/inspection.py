"""Inspection of result files before they are read: whole, their own data only, and not too much.

A result file ends with a seal: a mark and the SHA-256 digest of all bytes before it. HDF5 ignores
what follows its data, so other programs read the file as before; what they write has no seal.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from dalembert.budget import MEMORY, check_budget
from dalembert.errors import FileError

SEAL = b"\ndalembert sha256\n"
BLOCK = 1 << 20
APPENDED = 1 << 16
"""Bytes at the end of a file among which its seal is looked for."""
FILTERS = {1: "deflate", 2: "shuffle", 3: "fletcher32"}
"""Filters of HDF5 that are read; others may load code."""
ROUNDS = 100
"""Rounds of work for each array of a file, as the budget counts them."""
FEW = 32
"""Entries of an attribute of variable length that are read without counting."""
TEXTS_AT_ONCE = 1e8
"""Bytes of texts that are measured at once."""
REMEDY = "check that it is the file you mean"


def seal(path: str | Path) -> None:
    """Append the digest of a file to it."""
    digest = _digest(path, os.path.getsize(path))
    with open(path, "ab") as stream:
        stream.write(SEAL + digest)


def check_seal(path: str | Path) -> bool:
    """Compare a file with its seal; whether it has one. Bytes appended to a file do not hide it.

    Raises
    ------
    FileError
        The file has changed since it was written.
    """
    begin = max(os.path.getsize(path) - APPENDED, 0)
    with open(path, "rb") as stream:
        stream.seek(begin)
        end = stream.read(APPENDED)
    mark = end.rfind(SEAL)
    if mark < 0:
        return False
    digest = end[mark + len(SEAL) :][: hashlib.sha256().digest_size]
    if digest != _digest(path, begin + mark):
        raise FileError(
            f"{path}: is damaged: its content differs from its checksum; run the model again, or "
            "take a copy of the file"
        )
    return True


def _digest(path: str | Path, size: int) -> bytes:
    """SHA-256 of the first bytes of a file."""
    made = hashlib.sha256()
    with open(path, "rb") as stream:
        while size > 0 and (block := stream.read(min(BLOCK, size))):
            made.update(block)
            size -= len(block)
    return made.digest()


def inspect(path: str | Path) -> None:
    """Refuse a file that reads other files, or that takes too much to read.

    Raises
    ------
    FileError
        External storage, a virtual dataset, a soft or external link, a filter that is not known.
    BudgetError
        Too many arrays, or too large ones; an array with several names counts once for each.
    """
    import h5py

    size, count, memory = os.path.getsize(path), 0, 0.0
    with h5py.File(path, "r") as file:
        for name, item in _items(path, file):
            count += 1
            check_budget(f"{path}: to read its arrays", rounds=ROUNDS * count, cure=REMEDY)
            _check_attributes(path, name, item, size)
            if isinstance(item, h5py.Dataset):
                _check_storage(path, name, item)
                memory += item.nbytes + 0.0
                check_budget(f"{path}: to unpack it", memory=memory, cure=REMEDY)
                memory += _text_bytes(path, name, item, size, memory)


def _items(path: str | Path, file: Any) -> Iterator[tuple[str, Any]]:
    """Groups and datasets by all of their names; links to elsewhere are not followed."""
    import h5py

    groups, seen = [("/", file["/"])], {_address(file["/"])}
    yield groups[0]
    while groups:
        prefix, group = groups.pop()
        for name in group:
            link, whole = group.get(name, getlink=True), f"{prefix}{name}"
            if not isinstance(link, h5py.HardLink):
                kind = "an external" if isinstance(link, h5py.ExternalLink) else "a soft"
                raise FileError(f"{path}: {whole[:80]!r} is {kind} link, which results do not have")
            item = group[name]
            yield whole, item
            if isinstance(item, h5py.Group):
                if (address := _address(item)) in seen:
                    raise FileError(f"{path}: the group {whole[:80]!r} is reached twice")
                seen.add(address)
                groups.append((f"{whole}/", item))


def _address(item: Any) -> int:
    import h5py

    return int(h5py.h5o.get_info(item.id).addr)


def _check_storage(path: str | Path, name: str, dataset: Any) -> None:
    import h5py

    made = dataset.id.get_create_plist()
    if made.get_external_count():
        raise FileError(f"{path}: {name[:80]!r} is stored in another file, which is not read")
    if made.get_layout() == h5py.h5d.VIRTUAL:
        raise FileError(f"{path}: {name[:80]!r} is a view of other datasets, which is not read")
    used = {made.get_filter(k)[0] for k in range(made.get_nfilters())}
    if used - FILTERS.keys() or (used and _varies(dataset.id.get_type())):
        raise FileError(f"{path}: {name[:80]!r} is packed in a way that results do not use")


def _varies(kind: Any) -> bool:
    """Entries have lengths of their own, which the size of the array leaves out."""
    import h5py

    if isinstance(kind, h5py.h5t.TypeCompoundID):
        return any(_varies(kind.get_member_type(k)) for k in range(kind.get_nmembers()))
    if isinstance(kind, h5py.h5t.TypeArrayID):
        return _varies(kind.get_super())
    return isinstance(kind, h5py.h5t.TypeVlenID) or (
        isinstance(kind, h5py.h5t.TypeStringID) and bool(kind.is_variable_str())
    )


def _text_bytes(path: str | Path, name: str, dataset: Any, size: int, before: float) -> float:
    """Bytes of texts, which may share one place in the file."""
    if not _varies(dataset.id.get_type()) or dataset.shape is None:
        return 0.0
    if dataset.ndim > 1:
        raise FileError(f"{path}: {name[:80]!r} is a table of texts, which results do not have")
    if dataset.ndim == 0:
        return float(size)
    total, block = 0.0, max(1, int(TEXTS_AT_ONCE / (size + 1)))
    for begin in range(0, dataset.shape[0], block):
        total += sum(len(text) for text in dataset[begin : begin + block])
        check_budget(f"{path}: to unpack it", memory=before + total, cure=REMEDY)
    return total


def _check_attributes(path: str | Path, name: str, item: Any, size: int) -> None:
    """Refuse attributes whose entries are much more than the file."""
    import h5py

    count = h5py.h5a.get_num_attrs(item.id)
    check_budget(f"{path}: to read the attributes of {name[:80]!r}", rounds=10 * count, cure=REMEDY)
    for k in range(count):
        attribute = h5py.h5a.open(item.id, index=k)
        entries = attribute.get_space().get_simple_extent_npoints()
        if entries > FEW and entries * size > MEMORY and _varies(attribute.get_type()):
            raise FileError(f"{path}: an attribute of {name[:80]!r} unpacks to too much")
