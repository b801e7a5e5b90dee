"""C text of a unit: the functions of the model, its constants and names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from string import Formatter

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.fmu.unit_functions import EXCHANGE, STEPS, Problem, UnitFunctions
from dalembert.fmu.variables import Variables
from dalembert.symbolic.native.source import c_functions

HEAD = """/* Equations and constants of the model {name}, written by dalembert {version}. */

#define CASADI_SYMBOL_EXPORT static
#define TOKEN {token}
{text}
typedef int (*Function)(const casadi_real**, casadi_real**, casadi_int*, casadi_real*, int);

typedef struct {{ /* positions by Newton's method: (t, y, x, p) -> y, r */
  Function function;
  int states, coordinates, rows;
  const char* const* names;
  const char *subject, *cure;
}} Closing;

typedef struct {{ /* functions of (t, held, x, p) of one interface type */
  int states, memory, held, rate_count;
  const Closing* closing;
  Function start, start_tangent, start_adjoint, rates, outputs, tangent, adjoint, begin;
}} Problem;
"""
DEAD_CENTRE = "the states do not determine it there; choose other ones by states=[...]"
NOT_ASSEMBLED = "the mechanism cannot be assembled with these parameters"


def c_source(functions: UnitFunctions, variables: Variables, token: str, version: str) -> str:
    """Text of ``model.h``.

    Raises
    ------
    UnsupportedError
        A function cannot be written as C.
    """
    text = c_functions(functions.functions)
    if text is None:
        raise UnsupportedError(
            f"{functions.model.name!r} cannot be exported: CasADi cannot write its steps as C; use "
            "another integrator"
        )
    name = "".join(c for c in functions.model.name if c.isprintable()).replace("*/", "* /")
    head = HEAD.format(name=name, version=version, token=quoted(token), text=text)
    lines = [*_sizes(functions, variables), *_tables(functions, variables)]
    return head + "\n".join([*lines, _absent(functions)])


def _sizes(functions: UnitFunctions, variables: Variables) -> list[str]:
    problems, closure = functions.problems, functions.model.closure
    exchange, steps = functions.exchange_problem, functions.step_problem
    every = functions.functions.values()
    limits = functions.limits[0]
    states = len(variables.states)
    step_rows = len(steps.rows) if steps else 0
    all_rows = len(functions.model.equation_names)
    most_states = max([states, *(p.states for p in problems)])
    most_held = max([p.held for p in problems] + [functions.model.start.y.size])
    sizes = {
        "MODEL_EXCHANGE": int(EXCHANGE in functions.kinds),
        "CO_SIMULATION": int(STEPS in functions.kinds),
        "PARAMETERS": len(variables.parameters),
        "START_COORDINATES": functions.model.start.y.size,
        "OUTPUT_COUNT": len(variables.outputs),
        "STATE_COUNT": states,
        "INDICATORS": len(variables.indicators),
        "LIMITS": limits.numel_out(0) if limits is not None else 0,
        "STEADY": int(bool(closure.recipe.states.steady)),
        "VIOLATION_ROWS": all_rows,
        "STEP_ROWS": step_rows,
        "CONDITIONED": int(bool(steps and "conditioning" in steps.functions)),
        "EXCHANGE_CONDITIONED": int(bool(exchange and "conditioning" in exchange.functions)),
        "TERM_COUNT": steps.functions["terms"].numel_out(0) if steps else 0,
        "MOST_STATES": most_states,
        "MOST_HELD": most_held,
        "MOST_NEXT": max(most_held, *(p.states + p.memory for p in problems)),
        "MOST_ROWS": 1
        + max(
            [all_rows, step_rows, len(functions.assembly_rows), functions.model.start.y.size]
            + [len(p.rows) for p in problems]
        ),
        "WORK_ARG": max(f.sz_arg() for f in every) + 1,
        "WORK_RES": max(f.sz_res() for f in every) + 1,
        "WORK_IW": max(f.sz_iw() for f in every) + 1,
        "WORK_W": max(f.sz_w() for f in every) + 1,
    }
    lines = [f"#define {key} {value}" for key, value in sizes.items()]
    rates = functions.stepping.sample_rates if functions.stepping else []
    lines += [
        f"#define SAMPLE_RATES {len(rates)}",
        _numbers("sample_time", [period for period, _ in rates]),
        _numbers("first_sample", [first for _, first in rates]),
    ]
    if (s := functions.stepping) is not None:
        failure = "Newton's method does not converge" if s.halves else "the state is not finite"
        assert functions.analysis.step is not None
        lines += [
            f"#define STEP_LENGTH {number(functions.analysis.step)}",
            f"#define CORRECTION_PERIOD {number(s.period)}",
            f"#define HALVES {int(s.halves)}",
            f"#define STEP_FAILURE {quoted(failure + '; shorten the step')}",
        ]
    return lines


def _tables(functions: UnitFunctions, variables: Variables) -> list[str]:
    model = functions.model
    limits = functions.limits[1]
    ranges = [pair for limit in limits for pair in limit.ranges]
    entities = [_limit_text(limit) for limit in limits for _ in limit.ranges]
    lines = [
        _numbers("nominal", model.nominal),
        _numbers("start_position", model.closure.anchor[1]),
        _numbers("state_sizes", functions.state_sizes),
        _numbers("minimum", [low for low, _ in ranges]),
        _numbers("above", [above for _, above in ranges]),
        _texts("limited", entities),
        _texts("parameter_names", [v.name for v in variables.parameters]),
        _texts("output_names", [v.name for v in variables.outputs]),
        _texts("state_names", [v.name for v in variables.states]),
        _texts("violation_names", model.equation_names),
        f"static const char kinds[] = {quoted(variables.kinds)};",
        *_closing("assembly", "start_closing", 0, model.start.y.size, functions.assembly_rows),
    ]
    if "steady_closing" in functions.functions:
        names = [model.guesses.names[k] for k in model.closure.recipe.states.steady]
        lines += _closing("steady_states", "steady_closing", 0, model.start.y.size, names)
    for problem in functions.problems:
        lines += _problem(problem, len(variables.states))
    if functions.stepping:
        samples = functions.stepping.samples
        count = 1 << len(functions.stepping.sample_rates)
        entries = ", ".join(f"step_sample_{k}" if k in samples else "0" for k in range(count))
        lines.append(f"static const Function samples[] = {{{entries}}};")
    if functions.step_problem:
        lines.append(_texts("step_rows", functions.step_problem.rows))
    return lines


def _problem(problem: Problem, states: int) -> list[str]:
    """Table of the functions of an interface type."""
    prefix = problem.prefix
    exchange = prefix == EXCHANGE
    closing = "closing" in problem.functions
    lines = []
    if closing:
        coordinates = problem.functions["closing"].numel_out(0)
        name, function = f"{prefix}_position", f"{prefix}_closing"
        texts = "model exchange", DEAD_CENTRE
        lines = _closing(name, function, problem.states, coordinates, problem.rows, *texts)
    names = ["start", "start_tangent", "start_adjoint", "rates", "outputs", "tangent", "adjoint"]
    entries = [
        f"{prefix}_{name}" if name in problem.functions else "0" for name in [*names, "begin"]
    ]
    sizes = problem.states, problem.memory, problem.held, states if exchange else 0
    at = f"&{prefix}_position" if closing else "0"
    values = ", ".join([*map(str, sizes), at, *entries])
    lines.append(f"static const Problem {prefix}_problem = {{{values}}};")
    return [*lines, f"#define {prefix.upper()}_PROBLEM (&{prefix}_problem)"]


def _absent(functions: UnitFunctions) -> str:
    """Macros of the interface types that the unit does not have."""
    absent = [kind for kind in (EXCHANGE, STEPS) if kind not in functions.kinds]
    return "".join(f"#define {kind.upper()}_PROBLEM ((const Problem*)0)\n" for kind in absent)


def _closing(
    name: str,
    function: str,
    states: int,
    coordinates: int,
    rows: Sequence[str],
    subject: str = "assembly",
    cure: str = NOT_ASSEMBLED,
) -> list[str]:
    texts = f"{name}_rows, {quoted(subject)}, {quoted(cure)}"
    sizes = f"{states}, {coordinates}, {len(rows) or 1}"
    return [
        _texts(f"{name}_rows", rows or ["none"]),
        f"static const Closing {name} = {{{function}, {sizes}, {texts}}};",
    ]


def _limit_text(limit: object) -> str:
    """Entity of a limit with its message, without formats."""
    entity, message = limit.entity, limit.message  # type: ignore[attr-defined]
    plain = "".join(text for text, *_ in Formatter().parse(message))
    return f"{entity} ({plain})" if message else entity


def number(value: float) -> str:
    """A number in C."""
    value = float(value)
    if np.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(value)


def quoted(text: str) -> str:
    """A text in C; characters beyond ASCII are UTF-8 in octal numbers."""
    plain = "".join(c for c in text if c.isprintable())
    for character in '\\"?':
        plain = plain.replace(character, "\\" + character)
    parts = (c if c.isascii() else "".join(f"\\{b:03o}" for b in c.encode()) for c in plain)
    return '"' + "".join(parts) + '"'


def _numbers(name: str, values: Iterable[float]) -> str:
    listed = ", ".join(map(number, values)) or "0"
    return f"static const double {name}[] = {{{listed}}};"


def _texts(name: str, texts: Sequence[str]) -> str:
    listed = ", ".join(map(quoted, texts)) or '""'
    return f"static const char* const {name}[] = {{{listed}}};"
