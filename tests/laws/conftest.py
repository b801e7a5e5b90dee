"""Settings of laws."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from dalembert.symbolic.evaluation import kernel


@pytest.fixture(scope="module", autouse=True)
def plain_graphs(request: pytest.FixtureRequest) -> Iterator[None]:
    """Graphs as they are written: to search them for equal parts takes a sixth of the time.

    That pays in long runs. Nightly runs (``-m thorough``), examples and published cases have it.
    """
    with pytest.MonkeyPatch.context() as patch:
        if "not thorough" in request.config.option.markexpr:
            patch.setattr(kernel, "CSE_OPERATIONS", 0)
        yield
