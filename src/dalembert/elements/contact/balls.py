"""Contact points of balls and walls, planar and spatial."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.contact.meeting import ContactPoint


def contact_of_balls(
    center_i: ca.SX, radius_i: ca.SX, center_j: ca.SX, radius_j: ca.SX
) -> ContactPoint:
    """``g = |r_j − r_i| − R_i − R_j``."""
    between = center_j - center_i
    length = ca.norm_2(between)
    gap, normal = length - radius_i - radius_j, between / length
    return ContactPoint(gap, normal, center_i + (radius_i + gap / 2) * normal)


def contact_at_wall(point: ca.SX, normal: ca.SX, center: ca.SX, radius: ca.SX) -> ContactPoint:
    """``g = n·(r − r_P) − R``."""
    gap = ca.dot(normal, center - point) - radius
    return ContactPoint(gap, normal, center - (radius + gap / 2) * normal)
