"""Functions of the C that CasADi writes around straight lines, as LLVM IR."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pycparser import c_ast, c_parser

from dalembert.symbolic.native.c_expressions import Expressions
from dalembert.symbolic.native.c_instructions import Surroundings
from dalembert.symbolic.native.c_text import CFunction
from dalembert.symbolic.native.c_types import INT, REAL, SMALL, VOID, CType, declared, pointer
from dalembert.symbolic.native.toolchain import NotTranslated

TYPES = "typedef double casadi_real; typedef long long int casadi_int;\n"
EVALUATION = (SMALL, [pointer(pointer(REAL)), pointer(pointer(REAL)), pointer(INT), pointer(REAL)])
"""Types of what evaluates a function of the graph, the number of its memory left out."""


def written_functions(
    functions: Sequence[CFunction], structs: Sequence[str], around: Surroundings
) -> list[str]:
    """IR of functions; ``around`` learns their types."""
    for function in functions:
        if function.straight:
            around.functions[function.name] = (EVALUATION[0], [*EVALUATION[1], SMALL])
    bodies = ["\n".join(f.lines) for f in functions if not f.straight]
    definitions = [f for f in _parsed("\n".join([*structs, *bodies])) if not _known(f, around)]
    return [line for node in definitions for line in _Function(node, around).text()]


def struct_lines(around: Surroundings) -> list[str]:
    """IR of the structs."""
    made = []
    for name, fields in around.structs.items():
        inside = ", ".join(kind.ir(around.real) for _, kind in fields)
        made.append(f"%struct.{name} = type {{ {inside} }}")
    return made


def _parsed(text: str) -> list[Any]:
    text = TYPES + text.replace("CASADI_CAST(casadi_real,", "((casadi_real)")
    try:
        return c_parser.CParser().parse(text.replace("CASADI_SYMBOL_EXPORT ", "")).ext
    except c_parser.ParseError as error:
        raise NotTranslated(f"C that it cannot read ({error})") from None


def _known(node: Any, around: Surroundings) -> bool:
    """Note the types that a definition states; true for what is no function."""
    if isinstance(node, c_ast.Typedef):
        return True
    if isinstance(node, c_ast.Decl) and isinstance(node.type, c_ast.Struct):
        fields = [(part.name, declared(part.type)) for part in node.type.decls]
        around.structs[node.type.name] = fields
        return True
    if not isinstance(node, c_ast.FuncDef):
        raise NotTranslated(f"{type(node).__name__} outside of functions")
    around.functions[node.decl.name] = (declared(node.decl.type.type), _given(node))
    return False


def _given(node: Any) -> list[CType]:
    """Types of the arguments; an array is given by its first element."""
    arguments = node.decl.type.args
    kinds = [declared(argument) for argument in (arguments.params if arguments else ())]
    return [pointer(k.target) if k.kind == "array" else k for k in kinds if k is not VOID]


class _Function(Expressions):
    """One definition."""

    def __init__(self, node: Any, around: Surroundings):
        super().__init__(around)
        self.node = node
        self.result, self.kinds = around.functions[node.decl.name]
        self.breaks: list[str] = []
        self.continues: list[str] = []

    def text(self) -> list[str]:
        """IR of the definition."""
        heads = []
        for number, kind in enumerate(self.kinds):
            name = self.node.decl.type.args.params[number].name
            place = self.place(kind)
            self.names[name] = (place, kind)
            self.store((f"%g{number}", kind), place, kind)
            heads.append(f"{kind.ir(self.real)} %g{number}")
        self.statement(self.node.body)
        head = f"define internal {self.result.ir(self.real)} @{self.node.decl.name}"
        last = "  ret void" if self.result is VOID else "  unreachable"
        return [f"{head}({', '.join(heads)}) nounwind {{", *self.places, *self.lines, last, "}"]

    def statement(self, node: Any) -> None:
        """Write a statement."""
        if type(node) in self._statements:
            self._statements[type(node)](self, node)
        else:
            self.value(node)

    def _compound(self, node: Any) -> None:
        outer = dict(self.names)
        for item in node.block_items or ():
            self.statement(item)
        self.names = outer

    def _declaration(self, node: Any) -> None:
        kind = declared(node.type)
        place = self.place(kind)
        self.names[node.name] = (place, kind)
        if isinstance(node.init, c_ast.InitList):
            for number, expression in enumerate(node.init.exprs):
                into = f"getelementptr {kind.ir(self.real)}, ptr {place}, i64 0, i64 {number}"
                self.store(self.value(expression), self.new(into), kind.target)
        elif node.init is not None:
            self.store(self.value(node.init), place, kind)

    def _declarations(self, node: Any) -> None:
        for one in node.decls:
            self._declaration(one)

    def _if(self, node: Any) -> None:
        yes, no, end = self.label("yes"), self.label("no"), self.label("end")
        self.branch(self.condition(node.cond), yes, no if node.iffalse else end)
        self.lines.append(f"{yes}:")
        self.statement(node.iftrue)
        if node.iffalse:
            self.lines += [f"  br label %{end}", f"{no}:"]
            self.statement(node.iffalse)
        self.begin(end)

    def _loop(self, node: Any) -> None:
        """``for`` and ``while``, and ``do … while``, which tests last."""
        test, body = self.label("test"), self.label("body")
        following, end = self.label("next"), self.label("end")
        outer = dict(self.names)
        if isinstance(node, c_ast.For) and node.init:
            self.statement(node.init)
        if isinstance(node, c_ast.DoWhile):
            self.lines.append(f"  br label %{body}")
            self.lines.append(f"{test}:")
        else:
            self.begin(test)
        if node.cond is None:
            self.lines.append(f"  br label %{body}")
        else:
            self.branch(self.condition(node.cond), body, end)
        self.lines.append(f"{body}:")
        self.breaks.append(end)
        self.continues.append(following)
        self.statement(node.stmt)
        self.begin(following)
        if isinstance(node, c_ast.For) and node.next:
            self.value(node.next)
        self.lines += [f"  br label %{test}", f"{end}:"]
        self.breaks.pop()
        self.continues.pop()
        self.names = outer

    def _switch(self, node: Any) -> None:
        value = self.converted(self.value(node.cond), INT)
        end, cases, other = self.label("end"), list[tuple[str, str]](), ""
        parts = []
        for item in node.stmt.block_items or ():
            label = self.label("case")
            if isinstance(item, c_ast.Case):
                cases.append((self.converted(self.value(item.expr), INT), label))
            elif isinstance(item, c_ast.Default):
                other = label
            else:
                raise NotTranslated("a switch with statements before its cases")
            parts.append((label, item.stmts or ()))
        choices = " ".join(f"i64 {number}, label %{label}" for number, label in cases)
        self.lines.append(f"  switch i64 {value}, label %{other or end} [ {choices} ]")
        self.lines.append(f"{self.label('dead')}:")
        self.breaks.append(end)
        for label, statements in parts:
            self.begin(label)
            for statement in statements:
                self.statement(statement)
        self.begin(end)
        self.breaks.pop()

    def _return(self, node: Any) -> None:
        if node.expr is None:
            self.lines.append("  ret void")
        else:
            made = self.converted(self.value(node.expr), self.result)
            self.lines.append(f"  ret {self.result.ir(self.real)} {made}")
        self.lines.append(f"{self.label('dead')}:")

    def _break(self, node: Any) -> None:
        self.jump(self.breaks[-1])

    def _continue(self, node: Any) -> None:
        self.jump(self.continues[-1])

    def _empty(self, node: Any) -> None:
        """Nothing."""

    _statements: dict[type, Callable[[Any, Any], None]] = {
        c_ast.Compound: _compound,
        c_ast.Decl: _declaration,
        c_ast.DeclList: _declarations,
        c_ast.If: _if,
        c_ast.For: _loop,
        c_ast.While: _loop,
        c_ast.DoWhile: _loop,
        c_ast.Switch: _switch,
        c_ast.Return: _return,
        c_ast.Break: _break,
        c_ast.Continue: _continue,
        c_ast.EmptyStatement: _empty,
    }
