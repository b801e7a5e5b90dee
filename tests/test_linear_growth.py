"""Work of building a model grows in proportion to its size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dalembert.io.model_file import check_model_data
from dalembert.io.reading import parse_document
from dalembert.model.graph.parts import MechanismParts
from dalembert.results.files.contents import Contents


def chain(count: int) -> str:
    """Text of a chain of bars."""
    bodies = [f'b{k} = {{ type = "Bar", length = 0.1, mass = 0.1 }}' for k in range(count)]
    joints = ['j0 = { type = "Revolute", connect = ["ground", "b0.start"] }'] + [
        f'j{k} = {{ type = "Revolute", connect = ["b{k - 1}.end", "b{k}.start"] }}'
        for k in range(1, count)
    ]
    return "\n".join(["format = 1", "[bodies]", *bodies, "[joints]", *joints])


def test_all_bodies_are_listed_equally_often_in_large_models(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    counts: list[int] = []
    listed = MechanismParts.bodies.fget
    assert listed is not None

    def counted(parts: MechanismParts) -> list:
        counts[-1] += 1
        return listed(parts)

    monkeypatch.setattr(MechanismParts, "bodies", property(counted))
    for count in (3, 12):
        counts.append(0)
        path = Path("chain.toml")
        assert len(check_model_data(parse_document(path, chain(count)), path).model().bodies)
    assert counts[0] == counts[1]


def test_labels_are_found_at_their_first_place() -> None:
    names = ["a", "b", "a"]
    values = np.arange(6.0).reshape(2, 3)
    contents = Contents.from_arrays({"x": (("time", "body"), values)}, {"body": names}, {})
    assert contents.at("x", body="a").tolist() == [0.0, 3.0]
    assert contents.at("x", body="b").tolist() == [1.0, 4.0]
