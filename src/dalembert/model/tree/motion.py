"""Poses, speeds and accelerations of a tree of bodies: ``g(q)``, ``D u`` and ``γ`` (6.1), (6.17).

Each body adds its own joint to what its carrier does, so that everything grows with the number
of bodies and no more.
"""

from __future__ import annotations

from collections.abc import Iterable

import casadi as ca

from dalembert.elements.coordinates import Coordinates
from dalembert.model.tree.basis import Branch, TreeBasis
from dalembert.model.tree.link import Link, Step
from dalembert.symbolic.formulas.expression import stack


class TreeMotion:
    """Motion of all groups of coordinates in joint coordinates.

    Parameters
    ----------
    links : carriers before the bodies they carry
    groups : groups of coordinates in the order of y and v

    Attributes
    ----------
    q, u, a : SX symbols: joint coordinates (k_q,), their speeds (k,) and ``u̇``
    rate : SX (k_q,), ``q̇``
    columns : of u, for each link
    pose : SX, ``g(q)``
    basis : TreeBasis, ``D`` and ``E``
    speed, gamma, acceleration : SX (n,), ``D u``, ``γ`` and ``D u̇ + γ``
    """

    def __init__(self, links: list[Link], groups: list[Coordinates]):
        self.links = links
        self.q = stack(link.space.pose for link in links)
        self.u = stack(link.space.twist for link in links)
        self.a = stack(link.space.acceleration_symbols for link in links)
        self.rate = stack(link.space.pose_rate for link in links)
        row_spans = _spans(group.twist.numel() for group in groups)
        rows_of = {group.name: rows for group, rows in zip(groups, row_spans, strict=True)}
        self.columns = columns = _spans(link.space.twist.numel() for link in links)
        open_columns = _spans(link.equation_count for link in links)
        index = {link.group.name: k for k, link in enumerate(links)}
        steps: list[Step] = []
        branches: list[Branch] = []
        for k, link in enumerate(links):
            parent = None if link.carrier is None else index.get(link.carrier.name)
            step = link.step(None if parent is None else steps[parent])
            spans = rows_of[link.group.name], columns[k], open_columns[k]
            operators = step.transport, step.subspace, step.coupling, step.opening, step.projection
            branches.append(Branch(parent, *spans, *operators))
            steps.append(step)
        by_group = {link.group.name: step for link, step in zip(links, steps, strict=True)}
        drifts = [step.drift for step in steps]
        self.pose = ca.densify(stack(by_group[group.name].pose for group in groups))
        self.speed = ca.densify(stack(by_group[group.name].twist for group in groups))
        self.basis = TreeBasis(branches, self.speed.numel())
        self.gamma = ca.densify(self.basis.times(ca.SX.zeros(self.u.numel()), drifts))
        self.acceleration = ca.densify(self.basis.times(self.a, drifts))


def _spans(sizes: Iterable[int]) -> list[slice]:
    """Consecutive slices of these sizes."""
    spans, begin = [], 0
    for size in sizes:
        spans.append(slice(begin, begin + size))
        begin += size
    return spans
