"""Where balls meet each other and walls, in the plane and in space."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.contact.meeting import Meeting


def meeting_of_balls(first: ca.SX, radius: ca.SX, second: ca.SX, other: ca.SX) -> Meeting:
    """``g = |r_j − r_i| − R_i − R_j``."""
    way = second - first
    length = ca.norm_2(way)
    gap, normal = length - radius - other, way / length
    return Meeting(gap, normal, first + (radius + gap / 2) * normal)


def meeting_at_wall(point: ca.SX, normal: ca.SX, center: ca.SX, radius: ca.SX) -> Meeting:
    """``g = n·(r − r_P) − R``."""
    gap = ca.dot(normal, center - point) - radius
    return Meeting(gap, normal, center - (radius + gap / 2) * normal)
