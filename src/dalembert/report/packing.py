"""Long columns of numbers in little room, as pages carry them.

A column is rounded to even steps from its least value on; what is kept are differences of the
steps, of the order in which they are smallest, by planes of bytes, all deflated together. What
stands in a page is a base64 text; the page unpacks it by itself. Whole numbers stay exact.
"""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np

LONG = 200
"""Numbers from which on a column is packed; a shorter one stays readable."""
BITS = 20
"""A column has so many steps: a millionth of its range, far below a pixel."""
ORDERS = (1, 2, 3)
"""Differences that are tried: high ones are small where a column is smooth, low ones in noise."""
EXACT_BITS = 40
"""Of columns that go on evenly, such as time, which cost nothing."""
EPSILON = 1e-12
"""Least step, relative to the largest value: below is round-off."""
ROUGH_BITS = 17
"""Of columns that are mostly noise, which nothing makes small: still far below a pixel."""


def packed(payload: dict[str, Any]) -> dict[str, Any]:
    """The payload with long columns of numbers as ``{"column": k}``, and ``columns``, all in one.

    Equal columns are kept once. A payload that is packed stays as it is.
    """
    if "columns" in payload:
        return payload
    packer = _Packer()
    made: dict[str, Any] = packer.replaced(payload)
    if packer.heads:
        text = base64.b64encode(zlib.compress(b"".join(packer.parts), 7)).decode("ascii")
        made["columns"] = {"heads": packer.heads, "data": text}
    return made


def unpacked(payload: dict[str, Any]) -> dict[str, Any]:
    """The payload with columns as lists again; None stands where a number was not finite."""
    if "columns" not in payload:
        return payload
    given = payload["columns"]
    data, at, columns = zlib.decompress(base64.b64decode(given["data"])), 0, []
    for head in given["heads"]:
        size, planes = int(head["n"]), int(head["planes"])
        columns.append(_read(head, np.frombuffer(data, np.uint8, size * planes, at)))
        at += size * planes
    rest = {key: value for key, value in payload.items() if key != "columns"}
    made: dict[str, Any] = _put_back(rest, columns)
    return made


class _Packer:
    """Takes columns one by one; knows those it has."""

    def __init__(self) -> None:
        self.heads: list[dict[str, Any]] = []
        self.parts: list[bytes] = []
        self.known: dict[bytes, int] = {}

    def replaced(self, value: Any) -> Any:
        if isinstance(value, dict):
            return {key: self.replaced(item) for key, item in value.items()}
        column = _column(value)
        if column is not None:
            return {"column": self.add(column)}
        if isinstance(value, (list, tuple)):
            return [self.replaced(item) for item in value]
        return value

    def add(self, column: np.ndarray) -> int:
        key = column.tobytes()
        if key not in self.known:
            self.known[key] = len(self.heads)
            head, part = _written(column)
            self.heads.append(head)
            self.parts.append(part)
        return self.known[key]


def _column(value: Any) -> np.ndarray | None:
    """(n,) of what is a long column of numbers."""
    if isinstance(value, np.ndarray):
        return value.astype(float) if value.ndim == 1 and value.size >= LONG else None
    if not isinstance(value, (list, tuple)) or len(value) < LONG:
        return None
    kinds = set(map(type, value))
    return np.array(value, dtype=float) if kinds <= {float, int, type(None)} else None


def _written(column: np.ndarray) -> tuple[dict[str, Any], bytes]:
    """Head and bytes of a column."""
    known = np.isfinite(column)
    low, high = (column[known].min(), column[known].max()) if known.any() else (0.0, 0.0)
    head: dict[str, Any] = {
        "n": column.size,
        "low": repr(float(low)),
        "step": "0",
        "planes": 0,
        "order": 1,
    }
    if not known.all():
        head["gaps"] = _gaps(known)
        column = np.where(known, column, column[_last(known)] if known.any() else 0.0)
    span = float(high - low)
    if not 0 < span < np.inf:
        return head, b""
    if span < 2.0**EXACT_BITS and np.array_equal(column, np.rint(column)):
        step = 1.0
    elif np.abs(np.diff(column, 2)).max() <= 1e-9 * span:
        step = span / 2**EXACT_BITS
    else:
        step = max(span / 2**BITS, EPSILON * max(abs(low), abs(high)))
    codes, order = _codes(column, low, step)
    if step not in (1.0, span / 2**EXACT_BITS) and np.median(codes) > 2 ** (BITS - 6):
        step = max(step, span / 2**ROUGH_BITS)
        codes, order = _codes(column, low, step)
    planes = max(1, (int(codes.max()).bit_length() + 7) // 8)
    table = codes.astype("<u8").view(np.uint8).reshape(-1, 8)[:, :planes]
    return head | {"step": repr(float(step)), "planes": planes, "order": order}, table.T.tobytes()


def _codes(column: np.ndarray, low: float, step: float) -> tuple[np.ndarray, int]:
    """Differences of the steps, signs folded in: 0, −1, 1, −2 … are 0, 1, 2, 3 …; their order."""
    steps = np.rint((column - low) / step).astype(np.int64)
    found = []
    for order in ORDERS:
        difference = np.diff(np.concatenate([np.zeros(order, dtype=np.int64), steps]), order)
        codes = np.where(difference < 0, -2 * difference - 1, 2 * difference)
        found.append((float(np.log2(codes + 1.0).sum()), order, codes))
    _, best, smallest = min(found, key=lambda one: one[:2])
    return smallest, best


def _read(head: dict[str, Any], table: np.ndarray) -> list[float | None]:
    values = np.full(int(head["n"]), float(head["low"]))
    if head["planes"]:
        powers = 256 ** np.arange(int(head["planes"]), dtype=np.int64)
        codes = powers @ table.reshape(-1, int(head["n"])).astype(np.int64)
        steps = np.where(codes & 1, -(codes + 1) // 2, codes // 2)
        for _ in range(int(head["order"])):
            steps = np.cumsum(steps)
        values += steps * float(head["step"])
    found: list[float | None] = values.tolist()
    for first, count in head.get("gaps", ()):
        found[first : first + count] = [None] * count
    return found


def _gaps(known: np.ndarray) -> list[list[int]]:
    """First index and length of the runs that are not known."""
    edges = np.flatnonzero(np.diff(np.concatenate([[True], known, [True]]).astype(int)))
    return [[int(a), int(b - a)] for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _last(known: np.ndarray) -> np.ndarray:
    """Of each index the last known one before it, else the first."""
    indices = np.where(known, np.arange(known.size), -1)
    return np.where((last := np.maximum.accumulate(indices)) < 0, np.argmax(known), last)


def _put_back(value: Any, columns: list[list[float | None]]) -> Any:
    if isinstance(value, dict):
        if set(value) == {"column"}:
            return columns[value["column"]]
        return {key: _put_back(item, columns) for key, item in value.items()}
    if isinstance(value, list):
        return [_put_back(item, columns) for item in value]
    return value
