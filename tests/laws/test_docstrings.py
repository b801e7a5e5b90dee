"""Examples of docstrings run as printed."""

import doctest
import inspect

import pytest

import dalembert as da

SHOWN = [
    name
    for name in da.__all__
    if (inspect.isfunction(getattr(da, name)) or inspect.isclass(getattr(da, name)))
    and ">>>" in (getattr(da, name).__doc__ or "")
]


@pytest.mark.parametrize("name", SHOWN)
def test_an_example_runs_as_printed(name):
    text = inspect.getdoc(getattr(da, name)) or ""
    example = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    told: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(example, out=told.append)
    assert not told, "".join(told)
