"""Models whose inputs a Python function sets at sample instants."""

from __future__ import annotations

from copy import copy

from dalembert.elements.blocks.sampled_function import Law, SampledFunction
from dalembert.errors import AnalysisError
from dalembert.model.graph.model import Model
from dalembert.model.graph.scheduled import ScheduledModel

NAME = "controller"
"""Name of the block, unless an element has it."""


class ControlledModel(ScheduledModel):
    """The model with held states in place of its inputs.

    Parameters
    ----------
    model : Model with inputs and outputs
    law : controller
    sample_time : [s]

    Raises
    ------
    AnalysisError
        The model has no inputs.
    UnsupportedError
        An input does not act through forces.
    """

    gradient_obstacle = (
        "a controller that is a Python function has no derivatives; write it as sampled blocks, "
        "such as da.blocks.SampledStateSpace, for gradients"
    )

    def __init__(self, model: Model, law: Law, sample_time: float):
        if not model.inputs:
            raise AnalysisError(
                "the model has no inputs that a controller could set; declare them by "
                "system.input(...)"
            )
        name = NAME
        while name in model.parts.elements:
            name += "_"
        self.block = SampledFunction(
            name,
            function=law,
            signals_in=tuple(model.outputs.values()),
            arguments=tuple(model.outputs),
            results=tuple(model.inputs),
            starts=tuple(declared.value for declared in model.inputs.values()),
            sample_time=sample_time,
        )
        parts = copy(model.parts)
        parts.elements = {**model.parts.elements, name: self.block}
        symbols = self.block.held_symbols
        schedules = {key: symbols[k] for k, key in enumerate(model.inputs)}
        super().__init__(Model.assembled(parts), schedules)
