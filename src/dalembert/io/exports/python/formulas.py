"""Formulas of a model file as Python expressions of the script's variables."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import Any

import casadi as ca

from dalembert.elements.body import BodyElement
from dalembert.errors import DalembertError
from dalembert.io.exports.python.code import number, quoted
from dalembert.io.exports.python.names import Variables
from dalembert.model.system import System
from dalembert.symbolic.formulas.expression import Expression
from dalembert.units.amounts import with_names
from dalembert.units.grammar import CONSTANTS

FUNCTIONS = {"abs": "abs", "min": "np.minimum", "max": "np.maximum"}
"""Functions that Python names differently; others are those of the package."""
FORMULA = "system.formula("
"""Call that reads the text of a formula, for measures that are no attributes."""
EXACT = 2**53
"""Upper limit of whole numbers that are written as such."""
DEPTH = 8
"""Depth to which two expressions are compared."""


class FormulaCode:
    """Writer of formulas.

    Parameters
    ----------
    system : of the file, complete
    variables : of the script
    histories : names of unknown histories
    """

    def __init__(self, system: System, variables: Variables, histories: Mapping[str, Any]):
        self.system, self.variables, self.histories = system, variables, histories

    def write(self, value: Any, local: Mapping[str, str] | None = None, text: bool = True) -> str:
        """Code of a number or formula.

        Parameters
        ----------
        local : further names → their code
        text : whether a number with a unit may stay a text
        """
        if not isinstance(value, str):
            return number(value)
        local = local or {}
        formula, amounts = with_names(value.strip(), lambda name: self._is_known(name, local))
        tree = ast.parse(formula, mode="eval")
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        if text and amounts and names <= set(amounts):
            return quoted(value.strip())
        writer = _Writer(self, formula, local, {n: number(a.value) for n, a in amounts.items()})
        code = ast.unparse(ast.fix_missing_locations(writer.visit(tree)))
        if FORMULA in code and not local and not names & set(self.histories):
            return f"{FORMULA}{quoted(value.strip())})"
        return code

    def _is_known(self, name: str, local: Mapping[str, str]) -> bool:
        if name in local or name in self.histories:
            return True
        try:
            return self.system.lookup(name) is not None
        except DalembertError:
            return True

    def name(self, name: str, local: Mapping[str, str]) -> str:
        """Code of a name without a dot."""
        if name in local:
            return local[name]
        if name in self.histories:
            return f"{self.variables.read('value', name)}.value"
        if ("value", name) in self.variables.names:
            return self.variables.read("value", name)
        if name == "t":
            return "da.t"
        if name in CONSTANTS:
            return f"math.{name}"
        return f"{FORMULA}{quoted(name)})"

    def measure(self, name: str) -> str:
        """Code of a measure: attributes of an element where they are this measure."""
        owner, _, quantity = name.partition(".")
        part: Any = self.system.elements.get(owner)
        if part is not None and ("part", owner) in self.variables.names:
            code = ""
            for key in quantity.split("."):
                if isinstance(part, BodyElement) and key in part.places and not _has(part, key):
                    kind = "point" if key in part.points else "frame"
                    part, code = part.places[key], f"{code}.{kind}({quoted(key)})"
                elif key.isidentifier() and _has(part, key):
                    part, code = getattr(part, key), f"{code}.{key}"
                else:
                    part = None
                    break
            if isinstance(part, Expression) and self._is(part, name):
                return f"{self.variables.read('part', owner)}{code}"
        return f"{FORMULA}{quoted(name)})"

    def _is(self, expression: Expression, name: str) -> bool:
        """Whether an expression is a measure."""
        expected = self.system.lookup(name)
        return (
            isinstance(expected, Expression)
            and expected.sx.shape == expression.sx.shape
            and bool(ca.is_equal(expected.sx, expression.sx, DEPTH))
        )


class _Writer(ast.NodeTransformer):
    """Replaces names, functions and amounts of a formula by their code."""

    def __init__(
        self,
        formulas: FormulaCode,
        text: str,
        local: Mapping[str, str],
        amounts: Mapping[str, str],
    ):
        self.formulas, self.text, self.local, self.amounts = formulas, text, local, amounts

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        if isinstance(node.value, int) and abs(node.value) > EXACT:
            return ast.Constant(float(node.value))
        return node

    def visit_Name(self, node: ast.Name) -> ast.AST:
        code = self.amounts.get(node.id)
        return ast.Name(self.formulas.name(node.id, self.local) if code is None else code)

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        return self._dotted(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        if not isinstance(node.func, ast.Name):
            return self._dotted(node)
        arguments = [self.visit(argument) for argument in node.args]
        if node.func.id == "interp":
            return ast.Call(arguments[1], arguments[:1], [])
        function = FUNCTIONS.get(node.func.id, f"da.{node.func.id}")
        return ast.Call(ast.Name(function), arguments, [])

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        return self._dotted(node)

    def _dotted(self, node: ast.AST) -> ast.AST:
        spelled = "".join((ast.get_source_segment(self.text, node) or "").split())
        return ast.Name(self.formulas.measure(spelled))


def _has(part: Any, key: str) -> bool:
    """Whether a part has an attribute."""
    try:
        return not key.startswith("_") and getattr(part, key, None) is not None
    except DalembertError:
        return False
