"""Names of places in the C text of loops over contacts: their numbers, and errors."""

import re
from pathlib import Path

import pytest

from dalembert.integrators.contact import machine_code, other_places, places, step_places
from dalembert.integrators.contact.place_names import MACROS, NAME, with_numbers
from dalembert.integrators.contact.places import Counts, Inputs, Outputs, Places, Status
from dalembert.integrators.contact.step_calls import Calls, StepOutcome
from dalembert.integrators.contact.step_places import Descriptions, Limits, Shares

SOURCES = sorted((Path(machine_code.__file__).parent / "sources").glob("*.c"))
TABLES = [
    table
    for module in (places, step_places, other_places)
    for table in vars(module).values()
    if isinstance(table, type) and issubclass(table, Places) and table is not Places
]
BARE = re.compile(r"\b(?:arg|res|iw|sizes|status|settings|numbers)\[\d+\]")
COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x = arg[MOBILITY][r];", f"x = arg[{Inputs.MOBILITY}][r];"),
        ("arg[LIMITS][ROUNDING]", f"arg[{Inputs.LIMITS}][{Limits.ROUNDING}]"),
        ("((int*) arg[DESCRIPTIONS])[6*i+PAIR]", f"((int*) arg[51])[6*i+{Descriptions.PAIR}]"),
        ("iw[CONTACTS]*iw[COMPONENTS]", f"iw[{Counts.CONTACTS}]*iw[{Counts.COMPONENTS}]"),
        (
            "arg[SHARES][res[STATUS][RESIDUAL]<x[0] ? SHORT : WEIGHT]",
            f"arg[{Inputs.SHARES}][res[{Outputs.STATUS}][{Status.RESIDUAL}]<x[0]"
            f" ? {Shares.SHORT} : {Shares.WEIGHT}]",
        ),
        ("if (call==AGAIN) return MORE;", f"if (call=={Calls.AGAIN}) return {StepOutcome.MORE:d};"),
        ("#define CASADI_SYMBOL_EXPORT", "#define CASADI_SYMBOL_EXPORT"),
        ("x = -INFINITY;", "x = -INFINITY;"),
        ("/* P_N and res[IMPULSE] */", "/* P_N and res[IMPULSE] */"),
    ],
)
def test_names_become_numbers(text, expected):
    assert with_numbers(text, "shape_contacts.c") == expected


def test_a_file_may_have_its_own_tables():
    sweeps, newton = (with_numbers("iw[SPEEDS]", name) for name in ("sweeps.c", "newton_modes.c"))
    assert sweeps == f"iw[{other_places.SweepCounts.SPEEDS}]" != newton == f"iw[{Counts.SPEEDS}]"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x = arg[MOBILTY][r];", ["sweep.c", "arg[MOBILTY]", "Inputs", "MOBILITY"]),
        ("x = iw[MOBILITY];", ["iw[MOBILITY]", "Counts", "COMPONENTS"]),
        ("x = arg[LIMITS][SHORT];", ["arg[LIMITS][SHORT]", "ROUNDING"]),
        ("x = row[CONTACTS];", ["CONTACTS", "'row'"]),
        ("return CLOSE;", ["sweep.c", "CLOSE", "CLOSED"]),
    ],
)
def test_an_unknown_name_is_an_error(text, words):
    with pytest.raises(LookupError) as caught:
        with_numbers(text, "sweep.c")
    assert all(word in str(caught.value) for word in words)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.name)
def test_files_name_all_places(path):
    text = path.read_text()
    code = COMMENT.sub("", text)
    declared = re.findall(r"^ *(?:const )?casadi_real\* (\w+\[\d+\]);", code, re.MULTILINE)
    assert set(BARE.findall(code)) <= set(declared)
    assert set(NAME.findall(COMMENT.sub("", with_numbers(text, path.name)))) <= MACROS
    assert max(map(len, text.splitlines())) <= 110


@pytest.mark.parametrize(
    ("name", "array", "last"),
    [
        ("shape_contacts.c", "ahead", Inputs.AXES_AHEAD),
        ("position_correction.c", "inputs", Inputs.MASS),
        ("position_correction.c", "outputs", Outputs.LAST_MASS),
    ],
)
def test_copies_of_the_arrays_contain_what_is_used(name, array, last):
    text = next(path for path in SOURCES if path.name == name).read_text()
    (size,) = map(int, re.findall(rf"casadi_real\* {array}\[(\d+)\];", text))
    assert size == last + 1
    assert f"for (i=0; i<{size}; ++i)" in text


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.__name__)
def test_tables_have_no_empty_place(table):
    assert set(table.table().values()) == set(range(table.size()))


def test_numbers_are_at_their_places():
    limits = Limits.numbers({Limits.THETA: 0.5, Limits.LENGTH: 1e-3})
    assert limits.size == Limits.size()
    assert limits[Limits.THETA] == 0.5
    assert limits[Limits.LENGTH] == 1e-3
    assert abs(limits).sum() == 0.501
    assert Counts.listed({Counts.GROUPS: 2})[:4] == [0, 0, 2, 0]
    arrays = Inputs.arranged({Inputs.FRICTION: limits})
    assert len(arrays) == Inputs.FRICTION + 1
    assert arrays[-1] is limits
