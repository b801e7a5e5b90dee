"""Compiled C gives what the virtual machine gives, is compiled once, and mends its cache."""

from __future__ import annotations

import dataclasses
import multiprocessing
import re

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.symbolic import compiled
from dalembert.symbolic.backends import Automatic

needs_compiler = pytest.mark.skipif(
    compiled.find_compiler() is None, reason="no C compiler (cc, gcc, clang) on this machine"
)
SAME = 1e-12
"""Relative difference that rounding may leave."""
STRATEGIES = {
    "RK4": {},
    "no stabilization": {"stabilization": da.Stabilization()},
    "projection now and then": {"stabilization": da.Projection(every=3)},
    "null space": {"formulation": da.NullSpace()},
    "joint coordinates": {"coordinates": da.JointCoordinates()},
    "adaptive": {"integrator": da.DormandPrince()},
    "solved steps": {"integrator": da.Trapezoidal()},
    "variable order": {"integrator": da.Bdf()},
}


def four_bar(length: float = 1.0) -> da.Model:
    """Crank, coupler and rocker under gravity; lengths and masses are parameters."""
    system = da.System("four-bar", gravity=(0.0, -9.81))
    crank_length = system.parameter("l1", 0.4 * length)
    crank = system.add(
        planar.Bar(
            "crank",
            length=crank_length,
            mass=system.parameter("m1", 1.2),
            angle=1.1,
            angular_velocity=-2.0,
        )
    )
    coupler = system.add(planar.Bar("coupler", length=1.1 * length, mass=0.7, angle=0.4))
    rocker = system.add(planar.Bar("rocker", length=0.9 * length, mass=0.9, angle=1.4))
    ground = system.ground
    system.add(planar.Revolute("O", ground.point(0.0, 0.0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("C", ground.point(1.0, 0.0), rocker.start))
    return system.build()


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """An empty cache for every test."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("DALEMBERT_CACHE", str(folder))
    return folder


@pytest.fixture
def compilations(monkeypatch) -> list[str]:
    """What was compiled, in order."""
    done, compile_text = [], compiled.Compiler.compile

    def counted(self, text, target):
        done.append(text)
        compile_text(self, text, target)

    monkeypatch.setattr(compiled.Compiler, "compile", counted)
    return done


def run(model: da.Model, backend: str, **options) -> da.Motion:
    options = {"step": 0.004, "outputs": 130} | options
    return da.solve_dynamics(model, 0.5, backend=backend, **options)


def table(motion: da.Motion) -> dict[str, np.ndarray]:
    fields = dataclasses.fields(motion.trajectory)
    return {f.name: np.asarray(getattr(motion.trajectory, f.name)) for f in fields}


def assert_same(found, expected) -> None:
    scale = max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    np.testing.assert_allclose(found, expected, rtol=SAME, atol=SAME * scale)


def libraries(folder) -> list:
    return sorted(folder.glob(f"*{compiled.SUFFIX}"))


# same results -----------------------------------------------------------------------
@needs_compiler
@pytest.mark.parametrize("options", STRATEGIES.values(), ids=STRATEGIES)
def test_runs_outputs_and_gradients_are_those_of_the_virtual_machine(options, monkeypatch):
    if options:
        monkeypatch.setattr(compiled, "OPTIMISED", "-O0")  # compiled quicker
    model = four_bar()
    expected, found = run(model, "vm", **options), run(model, "c", **options)
    assert (expected.statistics["backend"], found.statistics["backend"]) == ("VM", "C")
    for name, values in table(expected).items():
        assert_same(table(found)[name], values)
    responses = [da.final("crank.angle"), da.Maximum("A.force_norm", smooth=0.1)]
    for method in ("adjoint", "direct"):
        old, new = (da.sensitivity(m, responses, method=method) for m in (expected, found))
        assert_same(new.values, old.values)


@needs_compiler
def test_what_is_too_large_stays_on_the_virtual_machine_and_says_so(monkeypatch, compilations):
    """Forty four-bars are three times faster as C, 160 of them slower than the virtual machine."""
    monkeypatch.setattr(compiled, "LARGE", 1000)
    model = four_bar()
    expected, found = run(model, "vm"), run(model, "c")
    assert re.fullmatch(r"VM \(.* MB of C would be slower\)", found.statistics["backend"])
    assert not compilations
    np.testing.assert_array_equal(found.trajectory.y, expected.trajectory.y)


@needs_compiler
def test_events_happen_at_the_same_instants():
    events = {
        "passes": "crank.angle",
        "ends": da.Event("crank.angle + 1.2", terminal=True),
    }
    model = four_bar()
    expected, found = (run(model, b, events=events) for b in ("vm", "c"))
    assert [e.name for e in expected.events] == ["passes", "ends"]
    assert [e.name for e in found.events] == ["passes", "ends"]
    assert_same([e.time for e in found.events], [e.time for e in expected.events])
    assert_same(found.trajectory.y, expected.trajectory.y)
    assert found.status.outcome == expected.status.outcome


@needs_compiler
def test_parameters_stay_inputs_of_what_was_compiled(compilations):
    model = four_bar()
    run(model, "c")
    count = len(compilations)
    changed = da.solve_dynamics(
        model, 0.5, step=0.004, outputs=130, backend="c", parameters={"l1": 0.45, "m1": 2.0}
    )
    assert count and len(compilations) == count
    expected = da.solve_dynamics(
        model, 0.5, step=0.004, outputs=130, parameters={"l1": 0.45, "m1": 2.0}
    )
    assert_same(changed.trajectory.y, expected.trajectory.y)
    assert np.abs(changed.trajectory.y - run(model, "c").trajectory.y).max() > 1e-3


@needs_compiler
def test_what_cannot_be_written_as_c_runs_on_the_virtual_machine_and_says_so():
    motion = run(four_bar(), "c", step=0.1, outputs=5, integrator=da.Cvodes())
    assert motion.status.success
    assert motion.statistics["backend"].startswith("VM (")


# cache ------------------------------------------------------------------------------
@needs_compiler
def test_the_second_model_finds_everything_compiled(cache, compilations):
    run(four_bar(), "c")
    count = len(compilations)
    assert count == len(libraries(cache)) > 0
    again = run(four_bar(), "c")
    assert len(compilations) == count
    assert again.statistics["backend"] == "C"
    run(four_bar(1.01), "c")  # a number that is no parameter is part of the text
    assert len(compilations) > count


@needs_compiler
@pytest.mark.parametrize("damage", [b"", b"not a library", None], ids=["empty", "text", "cut"])
def test_a_broken_library_is_made_again(cache, compilations, damage):
    expected = run(four_bar(), "vm")
    run(four_bar(), "c")
    count = len(compilations)
    for path in libraries(cache):
        whole = path.read_bytes()
        path.unlink()
        path.write_bytes(whole[: len(whole) // 2] if damage is None else damage)
    found = run(four_bar(), "c")
    assert len(compilations) == 2 * count
    assert_same(found.trajectory.y, expected.trajectory.y)


@needs_compiler
def test_another_text_or_compiler_makes_another_library(cache):
    compiler = compiled.needed_compiler()
    first = compiled.kept_path("int f;", compiler)
    assert first.parent == cache
    assert compiled.kept_path("int f;", compiler) == first
    assert compiled.kept_path("int g;", compiler) != first
    for change in ({"version": "another 1.0"}, {"command": (*compiler.command, "-m64")}):
        assert compiled.kept_path("int f;", dataclasses.replace(compiler, **change)) != first


@needs_compiler
def test_clearing_the_cache_deletes_what_was_compiled(cache):
    run(four_bar(), "c")
    count = len(libraries(cache))
    assert da.clear_cache() == count > 0
    assert not list(cache.iterdir())
    assert da.clear_cache() == 0


def _final_angle(_: int) -> float:
    return float(run(four_bar(), "c").values("crank.angle")[-1])


@needs_compiler
def test_processes_that_compile_the_same_at_once_do_no_harm(cache):
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        angles = pool.map(_final_angle, range(2))
    expected = float(run(four_bar(), "vm").values("crank.angle")[-1])
    assert_same(angles, [expected, expected])
    assert all(compiled.is_whole(path) for path in libraries(cache))
    assert not [path for path in cache.iterdir() if path.name.startswith(".")]


# choice -----------------------------------------------------------------------------
@needs_compiler
def test_auto_compiles_what_repays_it_and_takes_what_is_there(cache):
    assert run(four_bar(), "auto").statistics["backend"] == "VM"
    assert not libraries(cache)
    run(four_bar(), "c")
    assert run(four_bar(), "auto").statistics["backend"] == "C"
    da.clear_cache()
    long = da.solve_dynamics(four_bar(), 0.5, step=0.5 / 200_000, outputs=[0.5], backend="auto")
    assert long.statistics["backend"] == "C"


@needs_compiler
def test_auto_counts_the_work_of_repeated_runs():
    model, backend = four_bar(), Automatic()
    function = da.Dynamics(0.5).kernel(model).start.function
    answers = [backend.repeated(function, 10_000) for _ in range(40)]
    assert answers[0] is function
    assert answers[-1].is_a("External")
    assert_same(
        answers[-1](0.0, model.start.y, model.start.v, model.nominal).full(),
        function(0.0, model.start.y, model.start.v, model.nominal).full(),
    )


def test_an_unknown_backend_is_refused_with_the_known_ones():
    with pytest.raises(da.UnsupportedError, match=r"'gpu'.*'vm', 'c', 'auto'"):
        run(four_bar(), "gpu")


def test_without_a_compiler_c_names_the_cure_and_auto_runs(monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(da.UnsupportedError, match=r"no-such-compiler.*install gcc.*backend='vm'"):
        run(four_bar(), "c")
    motion = run(four_bar(), "auto", step=1e-5, outputs=[0.5])
    assert motion.status.success and motion.statistics["backend"] == "VM"


@needs_compiler
def test_a_cache_that_cannot_be_written_names_the_cure(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    monkeypatch.setenv("DALEMBERT_CACHE", str(blocked / "cache"))
    with pytest.raises(da.UnsupportedError, match="DALEMBERT_CACHE"):
        run(four_bar(), "c")


@needs_compiler
def test_a_compiler_that_fails_is_quoted(tmp_path, monkeypatch):
    script = tmp_path / "cc"
    script.write_text(
        '#!/bin/sh\n[ "$1" = --version ] && echo fake && exit 0\necho boom >&2; exit 3\n'
    )
    script.chmod(0o755)
    monkeypatch.setenv("CC", str(script))
    with pytest.raises(da.UnsupportedError, match=r"boom.*set CC"):
        run(four_bar(), "c")
    assert not list((tmp_path / "cache").iterdir())
    motion = run(four_bar(), "auto", step=0.5 / 100_000, outputs=[0.5])
    assert motion.statistics["backend"] == "VM"
