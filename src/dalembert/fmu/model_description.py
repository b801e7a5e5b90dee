"""``modelDescription.xml`` of a unit, for FMI 3.0 and 2.0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as Xml

import numpy as np

from dalembert.errors import ExpressionError
from dalembert.fmu.unit_functions import EXCHANGE, STEPS
from dalembert.fmu.variables import TIME, Variable, Variables
from dalembert.units.unit import unit

BASES = ("kg", "m", "s", "A", "K", "rad")
"""Base units of FMI that dimensions of models have."""


@dataclass(frozen=True, eq=False)
class Description:
    """Content of the description of a unit.

    Attributes
    ----------
    name, description, identifier, token, tool : of the model, its C identifier, its token and the
        program that wrote it
    kinds : interface types
    variables : Variables
    dependencies : flags of rates and outputs by the time, the states and the parameters
    state_sizes : natural sizes of the states
    begin, duration, step : of the default experiment [s]
    """

    name: str
    description: str
    identifier: str
    token: str
    tool: str
    kinds: Sequence[str]
    variables: Variables
    dependencies: tuple[np.ndarray, ...]
    state_sizes: np.ndarray
    begin: float
    duration: float
    step: float

    # common ---------------------------------------------------------------------------
    def text(self, version: int) -> str:
        """The description for FMI 3.0 or 2.0."""
        root = self._fmi3() if version == 3 else self._fmi2()
        Xml.indent(root)
        text = Xml.tostring(root, encoding="unicode")
        return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'

    def _root(self, version: str, token: str, **more: str) -> Xml.Element:
        texts = {"fmiVersion": version, "modelName": self.name, token: self.token}
        texts |= {"description": self.description} if self.description else {}
        return _element(
            None, "fmiModelDescription", **texts, generationTool=self.tool,
            variableNamingConvention="flat", **more,
        )  # fmt: skip

    def _frame(self, root: Xml.Element, default: dict[str, str]) -> None:
        """Units, categories of messages and the default experiment."""
        units = Xml.SubElement(root, "UnitDefinitions")
        used = {v.unit: {v.display_unit for v in self.variables.all if v.unit == v_unit}
                for v in self.variables.all if (v_unit := v.unit)}  # fmt: skip
        for name, display in sorted(used.items()):
            _unit(_element(units, "Unit", name=name), name, sorted(display - {""}))
        categories = Xml.SubElement(root, "LogCategories")
        _element(categories, "Category", name="logStatusError", description="errors")
        _element(categories, "Category", name="logStatusWarning", description="warnings")
        text = "trial steps of an integrator without a position"
        _element(categories, "Category", name="logStatusDiscard", description=text)
        span = {
            "startTime": _number(self.begin),
            "stopTime": _number(self.begin + self.duration),
        }
        _element(root, "DefaultExperiment", **span, **default)

    def _depends(self, row: int, causalities: Sequence[str]) -> list[int]:
        """Value references of the time, states and parameters that determine a rate or output."""
        by_time, by_state, by_parameter = (pattern[row] for pattern in self.dependencies)
        pairs = zip(self.variables.parameters, by_parameter, strict=True)
        states = zip(self.variables.states, by_state, strict=True)
        return [
            *([TIME] if by_time.any() else []),
            *(v.reference for v, flag in pairs if flag and v.causality in causalities),
            *(v.reference for v, flag in states if flag),
        ]

    def _row(self, variable: Variable) -> int:
        """Row of a rate or an output in ``dependencies``."""
        rates = len(self.variables.rates)
        if variable.derivative is not None:
            return variable.reference - self.variables.rates[0].reference
        return rates + variable.reference - self.variables.outputs[0].reference

    @property
    def _has_dependencies(self) -> bool:
        """Dependencies are those of states of model exchange; steps have others."""
        return EXCHANGE in self.kinds

    # FMI 3.0 --------------------------------------------------------------------------
    def _fmi3(self) -> Xml.Element:
        root = self._root("3.0", "instantiationToken")
        common = {
            "modelIdentifier": self.identifier,
            "canGetAndSetFMUState": "true",
            "canSerializeFMUState": "true",
            "providesDirectionalDerivatives": "true",
            "providesAdjointDerivatives": "true",
        }
        if EXCHANGE in self.kinds:
            _element(root, "ModelExchange", **common, needsCompletedIntegratorStep="true")
        if STEPS in self.kinds:
            step = {"fixedInternalStepSize": _number(self.step)}
            variable = {"canHandleVariableCommunicationStepSize": "true"}
            _element(root, "CoSimulation", **common, **variable, **step)
        self._frame(root, {"stepSize": _number(self.step)})
        listed = Xml.SubElement(root, "ModelVariables")
        sizes = self._sizes
        for v in self.variables.all:
            more = {"derivative": str(v.derivative)} if v.derivative is not None else {}
            attributes = _common(v) | _real(v) | more | sizes.get(v.reference, {})
            _element(listed, "Float64", **attributes)
        structure, own = Xml.SubElement(root, "ModelStructure"), self.variables
        for tag, group in (("Output", own.outputs), ("ContinuousStateDerivative", own.rates)):
            for v in group:
                depends = self._own_dependencies(v)
                _element(structure, tag, valueReference=str(v.reference), **depends)
        for v in (*own.outputs, *own.states, *own.rates):
            _element(structure, "InitialUnknown", valueReference=str(v.reference))
        for v in own.indicators:
            _element(structure, "EventIndicator", valueReference=str(v.reference))
        return root

    def _own_dependencies(self, variable: Variable) -> dict[str, str]:
        if not self._has_dependencies:
            return {}
        depends = self._depends(self._row(variable), ("input", "parameter"))
        return {"dependencies": " ".join(map(str, depends))}

    @property
    def _sizes(self) -> dict[int, dict[str, str]]:
        """Nominal values of the states."""
        pairs = zip(self.variables.states, self.state_sizes, strict=True)
        return {v.reference: {"nominal": _number(size)} for v, size in pairs}

    # FMI 2.0 --------------------------------------------------------------------------
    def _fmi2(self) -> Xml.Element:
        count = {"numberOfEventIndicators": str(len(self.variables.indicators))}
        root = self._root("2.0", "guid", **(count if EXCHANGE in self.kinds else {}))
        common = {
            "modelIdentifier": self.identifier,
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
            "providesDirectionalDerivative": "true",
        }
        if EXCHANGE in self.kinds:
            _sources(_element(root, "ModelExchange", **common))
        if STEPS in self.kinds:
            variable = {"canHandleVariableCommunicationStepSize": "true"}
            _sources(_element(root, "CoSimulation", **common, **variable))
        self._frame(root, {"stepSize": _number(self.step)})
        listed = Xml.SubElement(root, "ModelVariables")
        variables = [v for v in self.variables.all if v not in self.variables.indicators]
        index = {v.reference: str(k) for k, v in enumerate(variables, 1)}
        sizes = self._sizes
        for v in variables:
            scalar = _element(listed, "ScalarVariable", **_common(v))
            more = {"derivative": index[v.derivative]} if v.derivative is not None else {}
            _element(scalar, "Real", **_real(v), **more, **sizes.get(v.reference, {}))
        structure, own = Xml.SubElement(root, "ModelStructure"), self.variables
        for tag, group in (("Outputs", own.outputs), ("Derivatives", own.rates)):
            part = Xml.SubElement(structure, tag) if group else None
            for v in group:
                depends = {}
                if self._has_dependencies:
                    numbers = [index[r] for r in self._depends(self._row(v), ("input",))]
                    depends = {"dependencies": " ".join(numbers)}
                _element(part, "Unknown", index=index[v.reference], **depends)
        unknowns = (*own.outputs, *own.states, *own.rates)
        part = Xml.SubElement(structure, "InitialUnknowns") if unknowns else None
        for v in unknowns:
            _element(part, "Unknown", index=index[v.reference])
        return root


def build_description(identifier: str, definition: str) -> str:
    """``buildDescription.xml`` of the sources, for FMI 3.0."""
    root = _element(None, "fmiBuildDescription", fmiVersion="3.0")
    configuration = _element(root, "BuildConfiguration", modelIdentifier=identifier)
    files = _element(configuration, "SourceFileSet", language="C99")
    _element(files, "SourceFile", name=definition)
    _element(files, "IncludeDirectory", name="headers")
    Xml.indent(root)
    text = Xml.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _sources(element: Xml.Element) -> None:
    _element(Xml.SubElement(element, "SourceFiles"), "File", name="fmi2.c")


def _element(parent: Xml.Element | None, tag: str, **attributes: str) -> Xml.Element:
    clean = {key: _printable(text) for key, text in attributes.items()}
    return Xml.Element(tag, clean) if parent is None else Xml.SubElement(parent, tag, clean)


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else " " for c in text)


def _common(v: Variable) -> dict[str, str]:
    attributes = {"name": v.name, "valueReference": str(v.reference)}
    attributes |= {"description": v.description} if v.description else {}
    attributes |= {"causality": v.causality, "variability": v.variability}
    return attributes | ({"initial": v.initial} if v.initial else {})


def _real(v: Variable) -> dict[str, str]:
    attributes = {"unit": v.unit} if v.unit else {}
    if v.display_unit and v.unit:
        attributes["displayUnit"] = v.display_unit
    for key, value in (("min", v.minimum), ("max", v.maximum), ("start", v.start)):
        if value is not None:
            attributes[key] = _number(value)
    return attributes


def _unit(element: Xml.Element, name: str, displayed: list[str]) -> None:
    """Dimension of a unit and the units in which users see it."""
    try:
        exponents = unit(name).dimension
    except ExpressionError:  # such as "N or N m"
        return
    powers = {base: n for base, n in exponents.items() if base in BASES and n == int(n)}
    if set(exponents) <= {*powers, "cycle"}:
        _element(element, "BaseUnit", **{base: str(int(n)) for base, n in powers.items()})
    for display in displayed:
        _element(element, "DisplayUnit", name=display, factor=_number(1 / unit(display).factor))


def _number(value: float) -> str:
    return repr(float(value))
