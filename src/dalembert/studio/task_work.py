"""A design task of a text in a process of its own: progress, result and page."""

from __future__ import annotations

import os
import signal
import threading
import traceback
import warnings
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import DalembertError
from dalembert.interrupts import ctrl_c, defer_ctrl_c
from dalembert.io.decisions.runs import RUNS
from dalembert.io.decisions.synthesis import OWN
from dalembert.io.model_file import check_model_data
from dalembert.io.reading import parse_document
from dalembert.io.report import report_choices
from dalembert.report.page import render_page
from dalembert.studio.candidates import cards
from dalembert.studio.child import end_with_parent
from dalembert.studio.problems import Problem, problems_of

SECTIONS = tuple(RUNS)
"""Sections of design tasks."""
STOP = "stop"
"""Message that ends the search; its result so far is completed."""


@dataclass(frozen=True)
class TaskRequest:
    """A design task of a text.

    Attributes
    ----------
    section : of the file, such as ``optimize``
    text, path : of the model file
    """

    section: str
    text: str
    path: Path


@dataclass(frozen=True)
class Iteration:
    """An iteration of a search: its number and the objective."""

    number: int
    value: float


@dataclass(frozen=True)
class Outcome:
    """End of a task.

    Attributes
    ----------
    ok : whether there is a usable result
    interrupted : whether it was stopped, with the result so far
    sentence : result, or the reason of the failure
    page : HTML; empty if there is none
    designs : parameter → value in SI units, of each design that the page can select
    cards : candidates of a synthesis
    problems : errors with their places in the text
    """

    ok: bool = False
    interrupted: bool = False
    sentence: str = ""
    page: str = ""
    designs: tuple[dict[str, float], ...] = ()
    cards: tuple[dict[str, Any], ...] = ()
    problems: tuple[Problem, ...] = field(default=())


def work(connection: Connection, request: TaskRequest) -> None:
    """Run a task; the process ends with the connection."""
    end_with_parent()
    if os.name == "posix":
        signal.signal(signal.SIGINT, signal.default_int_handler)
    warnings.simplefilter("ignore")
    threading.Thread(target=_listen, args=(connection,), daemon=True).start()
    lock = threading.Lock()

    def send(message: float | Iteration | Outcome) -> None:
        with suppress(OSError), lock:
            connection.send(message)

    with ctrl_c(is_command=True) as signals:
        try:
            outcome = _run(request, send)
        except KeyboardInterrupt:
            outcome = Outcome(interrupted=True, sentence="stopped before there was a result")
        except DalembertError as error:
            problems = tuple(problems_of(error, request.text, request.path))
            if signals.pressed:
                outcome = Outcome(interrupted=True, sentence=f"stopped: {problems[0].message}")
            else:
                sentence = "\n".join(problem.message for problem in problems)
                outcome = Outcome(sentence=sentence, problems=problems)
        except Exception:
            message = f"internal error; please report it:\n{traceback.format_exc(limit=-3)}"
            outcome = Outcome(sentence=message)
        defer_ctrl_c()
        send(outcome)


def _listen(connection: Connection) -> None:
    """End the search on request, and the process with the server."""
    with suppress(EOFError, OSError):
        while True:
            if connection.recv() == STOP:
                os.kill(os.getpid(), signal.SIGINT)
    os._exit(1)


def _run(request: TaskRequest, send: Any) -> Outcome:
    file = check_model_data(parse_document(request.path, request.text), request.path)
    has_model = request.section != "synthesis"
    model = file.model() if has_model else None
    run = RUNS[request.section](file, model)

    def report(*numbers: float) -> None:
        if len(numbers) == 1:
            send(float(numbers[0]))
        elif np.isfinite(numbers[1]):
            send(Iteration(int(numbers[0]), float(numbers[1])))

    decision = run(report)
    defer_ctrl_c()
    views = report_choices(file, model) if has_model else {}
    page = render_page(decision.live_page(file.document.report.live, **views))
    synthesis = getattr(file.document, "synthesis", None)
    is_own = synthesis is not None and synthesis.linkage == OWN
    candidates = tuple(cards(decision, is_own)) if request.section == "synthesis" else ()
    return Outcome(
        decision.ok,
        decision.interrupted,
        "; ".join([decision.sentence, *map(str, decision.warnings)]),
        page,
        tuple(_designs(decision)),
        candidates,
    )


def _designs(decision: Any) -> list[dict[str, float]]:
    """Parameter values of the designs of a result, in the order of its page."""
    own: Any = vars(decision)
    if isinstance(own.get("x"), dict):
        return [{name: float(value) for name, value in own["x"].items()}]
    if isinstance(own.get("designs"), np.ndarray):
        return [dict(zip(decision.names, map(float, row), strict=True)) for row in own["designs"]]
    return []
