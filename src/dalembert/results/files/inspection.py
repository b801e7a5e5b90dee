"""Inspection of result files before reading: checksum, external references and size.

A result file ends with a checksum: a mark and the SHA-256 digest of all bytes before it. HDF5
ignores bytes after its data, so other programs can read the file; files that they write have no
checksum.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from dalembert.budget import MEMORY, check_budget
from dalembert.errors import FileError

if TYPE_CHECKING:
    import h5py

SEAL = b"\ndalembert sha256\n"
BLOCK = 1 << 20
APPENDED = 1 << 16
"""Bytes at the end of a file that are searched for the checksum."""
FILTERS = {1: "deflate", 2: "shuffle", 3: "fletcher32"}
"""HDF5 filters that are accepted; others may load code."""
ROUNDS = 100
"""Estimated cost per array of a file, in the rounds of the budget."""
MIN_COUNTED = 32
"""Upper limit of entries of a variable-length attribute that are read without a check."""
TEXTS_AT_ONCE = 1e8
"""Block size for measuring texts [bytes]."""
FIX = "check that it is the file you mean"


def seal(path: str | Path) -> None:
    """Append the checksum of a file to it."""
    digest = _digest(path, os.path.getsize(path))
    with open(path, "ab") as stream:
        stream.write(SEAL + digest)


def check_seal(path: str | Path) -> bool:
    """Verify the checksum of a file; returns whether it has one. Appended bytes are ignored.

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
    digest = hashlib.sha256()
    with open(path, "rb") as stream:
        while size > 0 and (block := stream.read(min(BLOCK, size))):
            digest.update(block)
            size -= len(block)
    return digest.digest()


def inspect(path: str | Path) -> None:
    """Refuse a file that refers to other files or exceeds the budget.

    Raises
    ------
    FileError
        External storage, a virtual dataset, a soft or external link, or an unknown filter.
    BudgetError
        Too many or too large arrays; an array with several names counts several times.
    """
    import h5py

    size, count, memory = os.path.getsize(path), 0, 0.0
    with h5py.File(path, "r") as file:
        for name, item in _walk(path, file):
            count += 1
            check_budget(f"{path}: to read its arrays", rounds=ROUNDS * count, cure=FIX)
            _check_attributes(path, name, item, size)
            if isinstance(item, h5py.Dataset):
                _check_storage(path, name, item)
                memory += item.nbytes + 0.0
                check_budget(f"{path}: to unpack it", memory=memory, cure=FIX)
                memory += _text_bytes(path, name, item, size, memory)


def _walk(path: str | Path, file: h5py.File) -> Iterator[tuple[str, h5py.Group | h5py.Dataset]]:
    """Groups and datasets by all of their names; links are refused."""
    import h5py

    groups, visited = [("/", file["/"])], {_address(file["/"])}
    yield groups[0]
    while groups:
        prefix, group = groups.pop()
        for name in group:
            link, full_name = group.get(name, getlink=True), f"{prefix}{name}"
            if not isinstance(link, h5py.HardLink):
                kind = "an external" if isinstance(link, h5py.ExternalLink) else "a soft"
                raise FileError(
                    f"{path}: {full_name[:80]!r} is {kind} link, which results do not have"
                )
            item = group[name]
            yield full_name, item
            if isinstance(item, h5py.Group):
                if (address := _address(item)) in visited:
                    raise FileError(f"{path}: the group {full_name[:80]!r} is reached twice")
                visited.add(address)
                groups.append((f"{full_name}/", item))


def _address(item: h5py.Group) -> int:
    import h5py

    return int(h5py.h5o.get_info(item.id).addr)


def _check_storage(path: str | Path, name: str, dataset: h5py.Dataset) -> None:
    import h5py

    properties = dataset.id.get_create_plist()
    if properties.get_external_count():
        raise FileError(f"{path}: {name[:80]!r} is stored in another file, which is not read")
    if properties.get_layout() == h5py.h5d.VIRTUAL:
        raise FileError(f"{path}: {name[:80]!r} is a view of other datasets, which is not read")
    filters = {properties.get_filter(k)[0] for k in range(properties.get_nfilters())}
    if filters - FILTERS.keys() or (filters and _has_variable_length(dataset.id.get_type())):
        raise FileError(f"{path}: {name[:80]!r} is packed in a way that results do not use")


def _has_variable_length(kind: h5py.h5t.TypeID) -> bool:
    """Whether entries have variable length, which the size of the array does not include."""
    import h5py

    if isinstance(kind, h5py.h5t.TypeCompoundID):
        return any(
            _has_variable_length(kind.get_member_type(k)) for k in range(kind.get_nmembers())
        )
    if isinstance(kind, h5py.h5t.TypeArrayID):
        return _has_variable_length(kind.get_super())
    return isinstance(kind, h5py.h5t.TypeVlenID) or (
        isinstance(kind, h5py.h5t.TypeStringID) and bool(kind.is_variable_str())
    )


def _text_bytes(
    path: str | Path, name: str, dataset: h5py.Dataset, size: int, counted: float
) -> float:
    """Bytes of texts, which may share storage in the file."""
    if not _has_variable_length(dataset.id.get_type()) or dataset.shape is None:
        return 0.0
    if dataset.ndim > 1:
        raise FileError(f"{path}: {name[:80]!r} is a table of texts, which results do not have")
    if dataset.ndim == 0:
        return float(size)
    total, block = 0.0, max(1, int(TEXTS_AT_ONCE / (size + 1)))
    for begin in range(0, dataset.shape[0], block):
        total += sum(len(text) for text in dataset[begin : begin + block])
        check_budget(f"{path}: to unpack it", memory=counted + total, cure=FIX)
    return total


def _check_attributes(
    path: str | Path, name: str, item: h5py.Group | h5py.Dataset, size: int
) -> None:
    """Refuse attributes that are much larger than the file."""
    import h5py

    count = h5py.h5a.get_num_attrs(item.id)
    check_budget(f"{path}: to read the attributes of {name[:80]!r}", rounds=10 * count, cure=FIX)
    for k in range(count):
        attribute = h5py.h5a.open(item.id, index=k)
        entries = attribute.get_space().get_simple_extent_npoints()
        if (
            entries > MIN_COUNTED
            and entries * size > MEMORY
            and _has_variable_length(attribute.get_type())
        ):
            raise FileError(f"{path}: an attribute of {name[:80]!r} unpacks to too much")
