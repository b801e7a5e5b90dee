"""What ``[[random]]`` of a file says."""

from __future__ import annotations

from typing import Any

from dalembert.design.reliability.nataf import Nataf
from dalembert.io.analyses import table_options
from dalembert.io.decisions.tables import distribution
from dalembert.io.model_file import ModelFile
from dalembert.text.wording import unknown


def random_parameters(file: ModelFile, model: Any) -> dict[str, Any]:
    """Random parameter → distribution.

    Raises
    ------
    ModelError
        Nothing is random, or an unknown parameter, with the place.
    """
    tables: list[Any] = file.document.random
    if not tables:
        cure = "is missing; add [[random]] with parameter, type and its numbers"
        raise file.located.error(cure, "random")
    made: dict[str, Any] = {}
    for k, table in enumerate(tables):
        name = table.parameter
        if name not in model.parameters:
            text = unknown("parameter", name, model.parameters)
            raise file.located.error(text, "random", k, "parameter")
        if name in made:
            text = f"{name!r} is random twice; give it one table"
            raise file.located.error(text, "random", k, "parameter")
        with file.located("random", k):
            made[name] = _distribution(table)
            made[name].check_units(model.parameters[name].unit)
    return made


def _distribution(table: Any) -> Any:
    options = table_options(table)
    options.pop("parameter", None)
    if "of" in options:
        options["of"] = _distribution(table.of)
    return distribution(table.type)(**options)


def correlations(file: ModelFile, random: dict[str, Any]) -> dict[tuple[str, str], float]:
    """Pair of random parameters → correlation, of ``[reliability]``.

    Raises
    ------
    ModelError
        An unknown name, or correlations that cannot be, with the place.
    """
    made: dict[tuple[str, str], float] = {}
    asked = file.document.reliability
    for k, table in enumerate([] if asked is None else asked.correlation):
        for j, name in enumerate(table.between):
            if name not in random:
                text = unknown("random parameter", name, random)
                raise file.located.error(text, "reliability", "correlation", k, "between", j)
        one, other = table.between
        made[one, other] = float(table.value)
    with file.located("reliability", "correlation"):
        Nataf(random, made)
    return made
