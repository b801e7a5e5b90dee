"""Settings common to all tests."""

from __future__ import annotations

import gc
import os
import signal
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # workers share the cores
os.environ.setdefault(  # kept for the next run of the tests
    "DALEMBERT_CACHE", str(Path(__file__).parents[1] / ".pytest_cache" / "machine_code")
)

import pytest
from browser import browser, session_browser, show  # noqa: F401
from hypothesis import settings
from processor_times import ProcessorTimes
from studio_desk import (  # noqa: F401
    desk,
    shared_desk,
    shared_page,
    still_server,
    studio_server,
)
from thorough import mark_products

from dalembert.io import json_schema
from dalembert.symbolic.evaluation import switching

if sys.dont_write_bytecode:  # programs that tests start would compile all modules again
    sys.pycache_prefix = str(Path(__file__).parents[1] / ".pytest_cache" / "bytecode")
    os.environ["PYTHONPYCACHEPREFIX"] = sys.pycache_prefix
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False


class NeverCompiled:
    """What is compiled beside a run never ends: it would take a worker's core, and come by chance.

    Tests of changing over put the true one back.
    """

    running = True

    def __init__(self, text: str, toolchain: object):
        pass


switching.Compilation = NeverCompiled  # type: ignore[assignment,misc]
gc.set_threshold(50_000, 20, 20)  # models are many objects that stay
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as a shell starts jobs in the background
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--processor-times",
        nargs="?",
        const="",
        metavar="FILE",
        help="list the processor time of the slowest files; write that of each test to FILE",
    )


def pytest_configure(config: pytest.Config) -> None:
    path = config.getoption("--processor-times")
    if path is not None:
        config.pluginmanager.register(ProcessorTimes(Path(path) if path else None))


@pytest.hookimpl(tryfirst=True)  # before thorough cases are taken out
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    mark_products(items)


def pytest_collection_finish() -> None:
    """Leave modules and tests, which stay too, out of all collections."""
    gc.collect()
    gc.freeze()


def pytest_sessionfinish() -> None:
    """Spare pytest's last collections, five in a row, all that the tests leave."""
    gc.freeze()


settings.register_profile(
    "dalembert", deadline=None, derandomize=True, max_examples=25, database=None
)
settings.load_profile("dalembert")


@pytest.fixture(scope="session")
def schema():
    """The schema of model files as a validator; ``test_cli`` checks the schema itself."""
    return pytest.importorskip("jsonschema").Draft202012Validator(json_schema())


@pytest.fixture(scope="session")
def pictures(tmp_path_factory) -> Path:
    """Where the examples draw."""
    return tmp_path_factory.mktemp("gallery")
