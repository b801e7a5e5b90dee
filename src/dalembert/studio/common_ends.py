"""Equal characters at the begin and the end of two texts."""

from __future__ import annotations


def common_ends(one: str, other: str) -> tuple[int, int]:
    """Numbers of equal first characters, and of equal last ones behind these."""
    head = _equal(one, other)
    rest = min(len(one), len(other)) - head
    tail = _equal(one[len(one) - rest :][::-1], other[len(other) - rest :][::-1])
    return head, tail


def _equal(one: str, other: str) -> int:
    """Number of equal first characters, by bisection, as slices are compared fast."""
    low, high = 0, min(len(one), len(other))
    while low < high:
        middle = (low + high + 1) // 2
        if one[low:middle] == other[low:middle]:
            low = middle
        else:
            high = middle - 1
    return low
