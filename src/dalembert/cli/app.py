"""The ``dalembert`` command: argument parsing, dispatch to one command, exit codes.

Exit codes: 0 done, 1 the analysis failed, 2 wrong input, 130 interrupted.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from io import TextIOWrapper

from cyclopts import App, CycloptsError

from dalembert.cli.console import DONE, FAILED, INTERRUPTED, WRONG_INPUT, WrongInput, fail
from dalembert.errors import AnalysisError, DalembertError
from dalembert.interrupts import ctrl_c

COMMANDS = {
    "examples": "List the example models, or copy one here.",
    "check": "Explain a model: degrees of freedom, parts, parameters and warnings.",
    "import": "Write the model of another program or a drawing as a model file: URDF, DXF, STEP …",
    "run": "Run the analysis of a model file; writes results and an interactive report.",
    "sensitivity": "Derivatives of the responses of a model file by its parameters.",
    "compare": "Compare formulations and integrators on a model: cost, violations, errors.",
    "optimize": "Find the parameter values that optimise a response of a model file.",
    "pareto": "Find the Pareto-optimal designs of a model file.",
    "reliability": "Find the probability that random parameters violate a limit.",
    "tolerance": "Find the scatter of a response within the tolerances of dimensions.",
    "synthesize": "Find linkages, or dimensions of a mechanism, for a path, a motion, a function.",
    "trajectory": "Find the optimal motion of a model file and its controls.",
    "identify": "Find the parameter values that explain measured time series.",
    "invert": "Find the forces and drives that explain measured motion.",
    "sweep": "Run the analysis of a model file at many designs; resumes an interrupted study.",
    "report": "Write the interactive report of a result file, or of two for comparison.",
    "studio": "Draw and write a model in the browser, with a live picture of it.",
    "export": "Write a model file or its results for other programs: JavaScript, FMU, glTF …",
    "film": "Write the motion of a result file as an animation, GIF or MP4.",
    "cache": "Show the compiled functions cached on disk, or delete them.",
    "completion": "Print the completion script of a shell: bash, zsh or fish.",
    "schema": "Print the JSON Schema of model files, for editors.",
}

FUNCTIONS = {"import": "import_file"}
"""Command → function and module, if Python reserves its name."""

EXAMPLES = {
    "import": "robot.urdf --output robot.toml",
    "optimize": "smooth_torque.toml --minimize torque_rms --vary k --output results",
    "pareto": "smooth_torque.toml --points 9 --output results",
    "reliability": "smooth_torque.toml --samples 1000 --output results",
    "tolerance": "smooth_torque.toml --samples 500 --output results",
    "synthesize": "path_optimization.toml --starts 40 --output results",
    "trajectory": "swing_up.toml --output results",
    "identify": "model.toml --data run_1.csv --data run_2.csv --output results",
    "invert": "model.toml --data run_3.csv --output results",
    "sweep": "four_bar.toml --workers 2 --output results",
    "studio": "four_bar.toml",
    "export": "four_bar.toml --to js --output page",
}
"""Command → arguments of an example; ``model.toml`` is the user's file, the others are supplied."""

HELP = """Analysis and design optimisation of constrained mechanical systems.

A mechanism or structure is described in a model file (TOML or JSON). Begin with

    dalembert examples four_bar     (copies an example here)
    dalembert check four_bar.toml   (explains it)
    dalembert run four_bar.toml     (computes, writes results and a report)

Exit codes: 0 done, 1 the analysis failed, 2 wrong input, 130 interrupted.
"""


def make_app() -> App:
    """The application; the module of a command is imported when the command is called."""
    app = App(name="dalembert", help=HELP, version=_version, help_format="markdown")
    for name, summary in COMMANDS.items():
        example = EXAMPLES.get(name)
        text = f"{summary}\n\nExample: dalembert {name} {example}" if example else summary
        function = FUNCTIONS.get(name, name)
        app.command(f"dalembert.cli.{function}:{function}", name=name, help=text)
    return app


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; never a traceback for wrong input."""
    arguments_list = list(sys.argv[1:] if arguments is None else arguments)
    as_json = "--json" in arguments_list
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):  # a terminal may lack characters
            stream.reconfigure(errors="backslashreplace")
    try:
        code = _run(arguments_list)
        sys.stdout.flush()  # a broken pipe is detected here
        return code
    except WrongInput as error:
        return fail(error.cause, WRONG_INPUT, as_json)
    except AnalysisError as error:
        return fail(error, FAILED, as_json)
    except DalembertError as error:
        return fail(error, WRONG_INPUT, as_json)
    except CycloptsError as error:
        hint = "'dalembert --help' lists the commands, 'dalembert COMMAND --help' their options"
        return fail(DalembertError(f"{error}\n{hint}"), WRONG_INPUT, as_json)
    except KeyboardInterrupt:
        return fail(DalembertError("interrupted"), INTERRUPTED, as_json)
    except BrokenPipeError:  # the process that reads the output, such as ``head``, has ended
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for the flush at exit
        return DONE


def _run(arguments: list[str]) -> int:
    app = make_app()
    app.suppress_keyboard_interrupt = False
    with ctrl_c(is_command=True) as signals:
        try:
            returned = app(
                arguments,
                exit_on_error=False,
                print_error=False,
                help_on_error=False,
                result_action="return_value",
            )
        except Exception as error:
            if signals.pressed:  # compiled code replaces the exception
                raise KeyboardInterrupt from error
            raise
    code = returned if isinstance(returned, int) else DONE
    if signals.pressed and code == DONE:  # an import may have swallowed the exception
        print("Error: interrupted; all written files are complete", file=sys.stderr)
        return INTERRUPTED
    return code


def _version() -> str:
    from dalembert import __version__

    return __version__
