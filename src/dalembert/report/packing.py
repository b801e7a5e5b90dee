"""Compression of long columns of numbers in pages.

A column is quantised in equal steps from its minimum. Differences of the steps, of the order that
makes them smallest, are stored as byte planes, deflated together and encoded as base64 text, which
the page unpacks. Integers and zeros stay exact.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np

MIN_LENGTH = 200
"""Lower limit of the length of a packed column."""
BITS = 20
"""Resolution of a column: a millionth of its range, far below a pixel."""
ORDERS = (1, 2, 3)
"""Orders of differences to try: high orders suit smooth columns, low orders noise."""
EXACT_BITS = 40
"""Resolution of evenly spaced columns, such as time, which compress to almost nothing."""
MIN_STEP = 1e-12
"""Lower limit of the step, relative to the largest value (round-off)."""
ROUGH_BITS = 17
"""Resolution of noisy columns, which compress poorly: still far below a pixel."""


def pack(payload: dict[str, Any]) -> dict[str, Any]:
    """Replace long columns of numbers by ``{"column": k}`` and add all of them as ``columns``.

    Equal columns are stored once. A packed payload is returned unchanged.
    """
    if "columns" in payload:
        return payload
    packer = _Packer()
    result: dict[str, Any] = packer.replace(payload)
    if packer.heads:
        text = base64.b64encode(zlib.compress(b"".join(packer.parts), 7)).decode("ascii")
        result["columns"] = {"heads": packer.heads, "data": text}
    return result


def unpack(payload: dict[str, Any]) -> dict[str, Any]:
    """Restore the columns of a packed payload as lists; None for numbers that are not finite."""
    if "columns" not in payload:
        return payload
    packed_columns = payload["columns"]
    data, offset, columns = zlib.decompress(base64.b64decode(packed_columns["data"])), 0, []
    for head in packed_columns["heads"]:
        size, planes = int(head["n"]), int(head["planes"])
        columns.append(_decode(head, np.frombuffer(data, np.uint8, size * planes, offset)))
        offset += size * planes
    rest = {key: value for key, value in payload.items() if key != "columns"}
    result: dict[str, Any] = _restore(rest, columns)
    return result


class _Packer:
    """Collector of columns; equal columns are stored once."""

    def __init__(self) -> None:
        self.heads: list[dict[str, Any]] = []
        self.parts: list[bytes] = []
        self.index_of: dict[bytes, int] = {}

    def replace(self, value: Any) -> Any:
        if isinstance(value, dict):
            return {key: self.replace(item) for key, item in value.items()}
        column = _column(value)
        if column is not None:
            return {"column": self.add(column)}
        if isinstance(value, (list, tuple)):
            return [self.replace(item) for item in value]
        return value

    def add(self, column: np.ndarray) -> int:
        key = column.tobytes()
        if key not in self.index_of:
            self.index_of[key] = len(self.heads)
            head, part = _encode(column)
            self.heads.append(head)
            self.parts.append(part)
        return self.index_of[key]


def _column(value: Any) -> np.ndarray | None:
    """(n,) array of a long column of numbers, else None."""
    if isinstance(value, np.ndarray):
        return value.astype(float) if value.ndim == 1 and value.size >= MIN_LENGTH else None
    if not isinstance(value, (list, tuple)) or len(value) < MIN_LENGTH:
        return None
    return np.array(value, dtype=float) if are_numbers(value) else None


def are_numbers(values: Sequence[Any]) -> bool:
    """Whether all values are numbers or None."""
    kinds = set(map(type, values))
    return all(issubclass(kind, float | int | None) and kind is not bool for kind in kinds)


def _encode(column: np.ndarray) -> tuple[dict[str, Any], bytes]:
    """Head and bytes of a column."""
    finite = np.isfinite(column)
    low, high = (column[finite].min(), column[finite].max()) if finite.any() else (0.0, 0.0)
    head: dict[str, Any] = {
        "n": column.size,
        "low": repr(float(low)),
        "step": "0",
        "planes": 0,
        "order": 1,
    }
    if not finite.all():
        head["gaps"] = _gaps(finite)
        column = np.where(finite, column, column[_last_finite(finite)] if finite.any() else 0.0)
    span = float(high - low)
    if not 0 < span < np.inf:
        return head, b""
    if span < 2.0**EXACT_BITS and np.array_equal(column, np.rint(column)):
        step = 1.0
    elif np.abs(np.diff(column, 2)).max() <= 1e-9 * span:
        step = span / 2**EXACT_BITS
    else:
        step = max(span / 2**BITS, MIN_STEP * max(abs(low), abs(high)))
    base = _grid_start(low, high, step)
    codes, order = _difference_codes(column, base, step)
    if step not in (1.0, span / 2**EXACT_BITS) and np.median(codes) > 2 ** (BITS - 6):
        step = max(step, span / 2**ROUGH_BITS)
        base = _grid_start(low, high, step)
        codes, order = _difference_codes(column, base, step)
    planes = max(1, (int(codes.max()).bit_length() + 7) // 8)
    table = codes.astype("<u8").view(np.uint8).reshape(-1, 8)[:, :planes]
    head |= {"low": repr(float(base)), "step": repr(float(step)), "planes": planes, "order": order}
    return head, table.T.tobytes()


def _grid_start(low: float, high: float, step: float) -> float:
    """Start of the grid: the minimum; a multiple of the step where zero is to be exact."""
    return float(np.floor(low / step) * step) if low < 0.0 <= high else float(low)


def _difference_codes(column: np.ndarray, low: float, step: float) -> tuple[np.ndarray, int]:
    """Zigzag-coded differences of the steps (0, −1, 1, −2 … → 0, 1, 2, 3 …) and their order."""
    steps = np.rint((column - low) / step).astype(np.int64)
    candidates = []
    for order in ORDERS:
        difference = np.diff(np.concatenate([np.zeros(order, dtype=np.int64), steps]), order)
        codes = np.where(difference < 0, -2 * difference - 1, 2 * difference)
        candidates.append((float(np.log2(codes + 1.0).sum()), order, codes))
    _, best, best_codes = min(candidates, key=lambda candidate: candidate[:2])
    return best_codes, best


def _decode(head: dict[str, Any], table: np.ndarray) -> list[float | None]:
    values = np.full(int(head["n"]), float(head["low"]))
    if head["planes"]:
        powers = 256 ** np.arange(int(head["planes"]), dtype=np.int64)
        codes = powers @ table.reshape(-1, int(head["n"])).astype(np.int64)
        steps = np.where(codes & 1, -(codes + 1) // 2, codes // 2)
        for _ in range(int(head["order"])):
            steps = np.cumsum(steps)
        values += steps * float(head["step"])
    numbers: list[float | None] = values.tolist()
    for first, count in head.get("gaps", ()):
        numbers[first : first + count] = [None] * count
    return numbers


def _gaps(finite: np.ndarray) -> list[list[int]]:
    """First index and length of the runs of values that are not finite."""
    edges = np.flatnonzero(np.diff(np.concatenate([[True], finite, [True]]).astype(int)))
    return [[int(a), int(b - a)] for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _last_finite(finite: np.ndarray) -> np.ndarray:
    """Index of the last finite value up to each index, else of the first finite one."""
    indices = np.where(finite, np.arange(finite.size), -1)
    return np.where((last := np.maximum.accumulate(indices)) < 0, np.argmax(finite), last)


def _restore(value: Any, columns: list[list[float | None]]) -> Any:
    if isinstance(value, dict):
        if set(value) == {"column"}:
            return columns[value["column"]]
        return {key: _restore(item, columns) for key, item in value.items()}
    if isinstance(value, list):
        return [_restore(item, columns) for item in value]
    return value
