"""Machine code gives what the virtual machine gives, is made once, and mends its cache."""

from __future__ import annotations

import dataclasses
import multiprocessing
import os
import re
import sys
import threading
import time

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.errors import SolverFailure
from dalembert.symbolic.evaluation import backends, switching
from dalembert.symbolic.evaluation.columns import NativeColumns, VirtualColumns
from dalembert.symbolic.native import (
    background,
    c_compiler,
    code_cache,
    llvm,
    source,
    translation,
)
from dalembert.symbolic.native.c_compiler import Compiler
from dalembert.symbolic.native.llvm import Llvm

needs_compiler = pytest.mark.skipif(
    c_compiler.find_compiler() is None, reason="no C compiler (cc, gcc, clang) on this machine"
)
COMPILED = ["jit", pytest.param("c", marks=needs_compiler)]
NAMES = {"jit": "LLVM", "c": "C"}
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
    "variable order": {"integrator": da.BDF()},
    "generalized-alpha": {"integrator": da.GeneralizedAlpha()},
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


def pendulum(length: float = 1.0) -> da.Model:
    """One bar on a pin, which is compiled quickly."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    crank_length = system.parameter("l1", 0.4 * length)
    mass = system.parameter("m1", 1.2)
    crank = system.add(planar.Bar("crank", length=crank_length, mass=mass, angle=1.1))
    system.add(planar.Revolute("O", system.ground.point(length - 1.0, 0.0), crank.start))
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
    done: list[str] = []
    for toolchain in (Compiler, Llvm):
        monkeypatch.setattr(toolchain, "build", _counted(toolchain.build, done))
    return done


def _counted(build, done: list[str]):
    def counted(self, text, target):
        done.append(text)
        build(self, text, target)

    return counted


def run(model: da.Model, backend: str, **options) -> da.Motion:
    options = {"step": 0.004, "outputs": 130} | options
    return da.solve_dynamics(model, 0.5, backend=backend, **options)


def table(motion: da.Motion) -> dict[str, np.ndarray]:
    fields = dataclasses.fields(motion.trajectory)
    return {f.name: np.asarray(getattr(motion.trajectory, f.name)) for f in fields}


def assert_same(computed, expected) -> None:
    scale = max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    np.testing.assert_allclose(computed, expected, rtol=SAME, atol=SAME * scale)


def files(folder) -> list:
    return sorted(path for path in folder.glob("*") if path.suffix in code_cache.SUFFIXES)


# same results -----------------------------------------------------------------------
BY_C = ["RK4", "adaptive", "solved steps"]
"""Strategies that are compiled as C, too, which takes longer and goes the same way."""
GRADIENTS = {
    ("jit", "RK4"): ("adjoint", "direct"),
    ("jit", "solved steps"): ("adjoint", "direct"),
    ("jit", "projection now and then"): ("adjoint",),
    ("jit", "adaptive"): ("adjoint",),
    ("jit", "generalized-alpha"): ("adjoint",),
    ("c", "RK4"): ("adjoint",),
    ("c", "solved steps"): ("adjoint",),
}
"""Methods whose functions are compiled, too."""
CASES = [("jit", name) for name in STRATEGIES] + [
    pytest.param("c", name, marks=needs_compiler) for name in BY_C
]


@pytest.mark.few(1)
@pytest.mark.parametrize(("backend", "strategy"), CASES)
def test_runs_outputs_and_gradients_are_those_of_the_virtual_machine(
    backend, strategy, monkeypatch
):
    options = STRATEGIES[strategy]
    monkeypatch.setattr(c_compiler, "OPTIMISED", "-O0")  # compiled quicker
    monkeypatch.setattr(llvm, "OPTIMISED", 1 if strategy == "RK4" else 0)
    model = four_bar()
    expected, motion = run(model, "vm", **options), run(model, backend, **options)
    assert expected.statistics["backend"] == "VM"
    assert motion.statistics["backend"] == NAMES[backend]
    for name, values in table(expected).items():
        assert_same(table(motion)[name], values)
    responses = [da.final("crank.angle"), da.Maximum("A.force_norm", smooth=0.02)]
    for method in GRADIENTS.get((backend, strategy), ()):
        old, new = (da.sensitivity(m, responses, method=method) for m in (expected, motion))
        assert_same(new.values, old.values)


@pytest.mark.few(1)
@pytest.mark.parametrize("integrator", [da.RK4(), da.DormandPrince()])
def test_explicit_steps_are_those_of_the_virtual_machine_to_the_last_bit(integrator):
    expected, computed = (run(four_bar(), b, integrator=integrator) for b in ("vm", "jit"))
    np.testing.assert_array_equal(computed.record.steps.x, expected.record.steps.x)


SCALAR = {
    name: getattr(ca, name)
    for name in """sin cos tan asin acos atan sinh cosh tanh asinh atanh exp log sqrt floor ceil
    fabs sign erf log1p expm1 sumsqr logic_not""".split()
}
PAIRS = {
    name: getattr(ca, name)
    for name in """fmin fmax fmod remainder atan2 hypot copysign power plus minus times rdivide
    lt le eq ne logic_and logic_or""".split()
}


@pytest.mark.parametrize("kind", [ca.SX, ca.MX], ids=["scalars", "matrices"])
def test_every_operation_gives_the_same_number(kind):
    x, y = kind.sym("x"), kind.sym("y")
    outputs = [f(x) for f in SCALAR.values()] + [f(x, y) for f in PAIRS.values()]
    outputs += [ca.acosh(1 + x * x), ca.if_else(x < y, x, 3 * y), x * ca.inf, ca.fmax(-ca.inf, y)]
    function = ca.Function("operations", [x, y], [ca.vertcat(*outputs)])
    rng = np.random.default_rng(5)
    inputs = [
        np.r_[0.0, -0.0, 1.0, rng.uniform(-1, 1, 20)],
        np.r_[0.0, 1.0, 1.0, rng.normal(size=20)],
    ]
    assert_columns_agree(function, *inputs)


def assert_columns_agree(function: ca.Function, *arguments, toolchain=None) -> None:
    text, count = source.c_source(function), arguments[0].shape[-1]
    native = NativeColumns(function, code_cache.compiled_loop(text, toolchain or Llvm()), "LLVM")
    for computed, expected in zip(
        native(count, *arguments), VirtualColumns(function)(count, *arguments), strict=True
    ):
        np.testing.assert_array_equal(computed, expected)


def test_graphs_of_matrices_give_the_same_numbers():
    """Factorisations, switches, loops and products that CasADi writes as functions of its own."""
    a, b, k = ca.MX.sym("a", 4, 4), ca.MX.sym("b", 4, 3), ca.MX.sym("k")
    small = ca.Function("small", [k], [ca.sin(k)])
    cases = [ca.Function(f"f{i}", [k], [i * k + 1]) for i in range(3)]
    switch = ca.Function.conditional("switch", cases, ca.Function("rest", [k], [-k]))
    outputs = [
        ca.solve(a + 9 * ca.DM.eye(4), b, "qr"),
        ca.mtimes(a.T, b),
        ca.norm_fro(a) + ca.mmax(b) - ca.mmin(b),
        ca.vertcat(*[switch(i, k) for i in range(-1, 4)]),
        small.mapaccum(7)(k) + small.map(7)(ca.repmat(k, 1, 7)),
        ca.bilin(a, b[:, 0], b[:, 1]) * ca.diag(a),
        a[::2, [3, 0]] + ca.sum1(b)[0],
        ca.densify(ca.triu(a)),
    ]
    function = ca.Function("matrices", [a, b, k], [ca.densify(o) for o in outputs])
    rng = np.random.default_rng(6)
    inputs = rng.normal(size=(4, 20)), rng.normal(size=(4, 15)), rng.normal(size=(1, 5))
    text = source.c_source(function)
    native = NativeColumns(function, code_cache.compiled_loop(text, Llvm()), "LLVM")
    for computed, expected in zip(
        native(5, *inputs), VirtualColumns(function)(5, *inputs), strict=True
    ):
        np.testing.assert_array_equal(computed, expected)


@pytest.mark.parametrize("backend", COMPILED)
def test_a_matrix_that_is_singular_stops_all_alike(backend):
    y, q = ca.MX.sym("y", 2), ca.MX.sym("q")
    matrix = ca.vertcat(ca.horzcat(1, q), ca.horzcat(q, 1))
    function = ca.Function("step", [y, q], [ca.solve(matrix, y, "qr")])
    results = [backends.BACKENDS[b]().columns(function, True) for b in ("vm", backend)]
    inputs = np.array([1.0, 2.0]), np.array([0.5, -2.0, 1.0, 3.0])
    said = []
    for columns in results:
        with pytest.raises(SolverFailure) as caught:
            columns(4, *inputs)
        said.append(caught.value.reason)
    assert said[0] == said[1]
    first, second = (columns(2, inputs[0], inputs[1][:2])[0] for columns in results)
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("backend", COMPILED)
def test_large_graphs_stay_on_the_virtual_machine_with_a_reason(backend, monkeypatch, cache):
    """A model of few equal parts, whose code is as long as its list of operations."""
    monkeypatch.setattr(Compiler, "longest", 1000)
    monkeypatch.setattr(translation, "MAX_OPERATIONS", 100)
    model = four_bar()
    expected, motion = run(model, "vm"), run(model, backend)
    assert re.fullmatch(
        r"VM \(.* (MB of C|different operations) would gain little\)", motion.statistics["backend"]
    )
    assert not files(cache)
    np.testing.assert_array_equal(motion.trajectory.y, expected.trajectory.y)


def test_events_happen_at_the_same_instants():
    events = {
        "passes": "crank.angle",
        "ends": da.Event("crank.angle + 1.2", terminal=True),
    }
    model = four_bar()
    expected, computed = (run(model, b, events=events) for b in ("vm", "jit"))
    assert [e.name for e in expected.events] == ["passes", "ends"]
    assert [e.name for e in computed.events] == ["passes", "ends"]
    assert_same([e.time for e in computed.events], [e.time for e in expected.events])
    assert_same(computed.trajectory.y, expected.trajectory.y)
    assert computed.status.outcome == expected.status.outcome


def test_parameters_stay_inputs_of_what_was_compiled(compilations):
    model = pendulum()
    run(model, "jit")
    count = len(compilations)
    changed = da.solve_dynamics(
        model, 0.5, step=0.004, outputs=130, backend="jit", parameters={"l1": 0.45, "m1": 2.0}
    )
    assert count and len(compilations) == count
    expected = da.solve_dynamics(
        model, 0.5, step=0.004, outputs=130, backend="vm", parameters={"l1": 0.45, "m1": 2.0}
    )
    assert_same(changed.trajectory.y, expected.trajectory.y)
    assert np.abs(changed.trajectory.y - run(model, "jit").trajectory.y).max() > 1e-3


@pytest.mark.parametrize("backend", COMPILED)
def test_graphs_without_c_code_run_on_the_virtual_machine_with_a_reason(backend):
    motion = run(pendulum(), backend, step=0.1, outputs=5, integrator=da.CVODES())
    assert motion.status.success
    assert motion.statistics["backend"].startswith("VM (")


def test_threads_may_call_the_same_machine_code():
    x, p = ca.SX.sym("x", 3), ca.SX.sym("p", 3)
    function = ca.Function("step", [x, p], [x + 0.01 * ca.sin(ca.cross(x, p))])
    columns = backends.BACKENDS["jit"]().columns(function, True, (1,))
    begins = np.random.default_rng(3).normal(size=(8, 3))
    expected = [columns(4000, begin, 1.0 + begin)[0] for begin in begins]
    results: dict[int, np.ndarray] = {}

    def work(k: int) -> None:
        for _ in range(5):
            (results[k],) = columns(4000, begins[k], 1.0 + begins[k])

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k, values in enumerate(expected):
        np.testing.assert_array_equal(results[k], values)


# cache ------------------------------------------------------------------------------
@pytest.mark.few(1)
@pytest.mark.parametrize("backend", COMPILED)
def test_the_second_model_finds_everything_compiled(backend, cache, compilations):
    run(pendulum(), backend)
    count = len(compilations)
    assert count == len(files(cache)) > 0
    again = run(pendulum(), backend)
    assert len(compilations) == count
    assert again.statistics["backend"] == NAMES[backend]
    run(pendulum(1.01), backend)  # a number that is no parameter is part of the text
    assert len(compilations) > count


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("backend", "damage"),
    [
        ("jit", b""),
        ("jit", b"not a library"),
        ("jit", None),
        pytest.param("c", None, marks=needs_compiler),
    ],
    ids=["empty", "text", "cut", "cut library"],
)
def test_a_broken_file_is_made_again(backend, cache, compilations, damage):
    expected = run(pendulum(), "vm")
    run(pendulum(), backend)
    count = len(compilations)
    for path in files(cache):
        whole = path.read_bytes()
        path.unlink()
        path.write_bytes(whole[: len(whole) // 2] if damage is None else damage)
    motion = run(pendulum(), backend)
    assert len(compilations) == 2 * count
    assert_same(motion.trajectory.y, expected.trajectory.y)


@pytest.mark.skipif(os.name == "nt", reason="needs the files of Unix")
@pytest.mark.parametrize("kind", ["pipe", "pipe for the checksum", "folder", "link to itself"])
def test_invalid_files_in_the_code_cache_are_replaced(kind, cache):
    text = source.c_source(ca.Function("f", [X], [X + 3]))
    code_cache.build(text, Llvm())
    path = code_cache.cache_path(text, Llvm())
    path = path.with_suffix(code_cache.SEAL) if "checksum" in kind else path
    path.unlink()
    if "pipe" in kind:
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
        (path / "more").touch()
    else:
        path.symlink_to(path.name)
    assert code_cache.cached_loop(text, Llvm()) is None
    code_cache.compiled_loop(text, Llvm())
    assert code_cache.is_whole(code_cache.cache_path(text, Llvm()))


@pytest.mark.skipif(os.name == "nt", reason="needs the permissions of Unix")
def test_machine_code_is_not_taken_from_where_others_may_write(cache):
    text = source.c_source(ca.Function("f", [X], [X + 4]))
    code_cache.build(text, Llvm())
    cache.chmod(0o777)
    assert code_cache.cached_loop(text, Llvm()) is None
    with pytest.raises(da.UnsupportedError, match=r"others may write in .*mode 777.*chmod 700"):
        run(pendulum(), "jit")
    assert run(pendulum(), "auto").status.success


def test_without_a_home_folder_machine_code_is_kept_among_temporary_files(monkeypatch, tmp_path):
    def nowhere():
        raise RuntimeError("Could not determine home directory.")

    for name in ("DALEMBERT_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(code_cache.Path, "home", nowhere)
    monkeypatch.setattr(code_cache.tempfile, "tempdir", str(tmp_path))
    assert da.clear_cache() == 0 and code_cache.cache_size() == (0, 0)
    code_cache.build(source.c_source(ca.Function("f", [X], [X + 5])), Llvm())
    assert code_cache.cache_folder().parent == tmp_path and da.clear_cache() == 1
    monkeypatch.setenv("DALEMBERT_CACHE", "~nobody-of-this-name/cache")
    assert code_cache.cache_size() == (0, 0)


X = ca.SX.sym("x")


@needs_compiler
def test_another_text_or_compiler_makes_another_library(cache):
    compiler = c_compiler.require_compiler()
    first = code_cache.cache_path("int f;", compiler)
    assert first.parent == cache
    assert code_cache.cache_path("int f;", compiler) == first
    assert code_cache.cache_path("int g;", compiler) != first
    for change in ({"version": "another 1.0"}, {"command": (*compiler.command, "-m64")}):
        assert code_cache.cache_path("int f;", dataclasses.replace(compiler, **change)) != first


def test_machine_code_is_filed_under_processor_version_and_lanes(monkeypatch):
    import llvmlite.binding

    first = code_cache.cache_path("int f;", Llvm())
    assert code_cache.cache_path("int f;", Llvm()) == first
    assert code_cache.cache_path("int f;", Llvm(lanes=4)) != first
    monkeypatch.setattr(llvmlite.binding, "get_host_cpu_name", lambda: "another")
    assert code_cache.cache_path("int f;", Llvm()) != first


def test_clearing_the_cache_deletes_what_was_compiled(cache):
    run(pendulum(), "jit")
    count = len(files(cache))
    assert code_cache.cache_size() == (count, sum(path.stat().st_size for path in files(cache)))
    assert da.clear_cache() == count > 0
    assert not list(cache.iterdir())
    assert da.clear_cache() == 0


def test_the_least_recently_used_code_is_deleted_first(cache, monkeypatch):
    x = ca.SX.sym("x")
    texts = [source.c_source(ca.Function("f", [x], [x + k])) for k in range(3)]
    for text in texts:
        code_cache.build(text, Llvm())
        time.sleep(0.02)
    monkeypatch.setattr(code_cache, "MAX_SIZE", 2.5 * files(cache)[0].stat().st_size)
    assert code_cache.cached_loop(texts[0], Llvm()) is not None
    code_cache.build(source.c_source(ca.Function("f", [x], [x + 9])), Llvm())
    assert [code_cache.is_whole(code_cache.cache_path(text, Llvm())) for text in texts] == [1, 0, 0]


def _final_angle(backend: str) -> float:
    return float(run(pendulum(), backend).values("crank.angle")[-1])


@pytest.mark.thorough
def test_processes_that_compile_the_same_at_once_do_no_harm(cache):
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        angles = pool.map(_final_angle, ["jit", "jit"])
    expected = float(run(pendulum(), "vm").values("crank.angle")[-1])
    assert_same(angles, [expected, expected])
    assert all(code_cache.is_whole(path) for path in files(cache))
    assert not [path for path in cache.iterdir() if path.name.startswith(".")]


# choice -----------------------------------------------------------------------------
def test_auto_compiles_what_repays_it_and_takes_what_is_there(cache):
    assert run(four_bar(), "auto", outputs=[0.5]).statistics["backend"] == "VM"
    assert not list(cache.glob("*"))
    long = {"step": 0.5 / 100_000, "outputs": [0.5]}
    assert run(four_bar(), "auto", **long).statistics["backend"] == "LLVM"
    shorter = run(four_bar(), "auto", step=0.5 / 4000, outputs=[0.5])
    assert shorter.statistics["backend"] == "LLVM"


def test_auto_is_the_default_and_changes_over_while_it_runs(monkeypatch):
    """Nobody announces how often short runs are repeated."""
    assert da.Dynamics(1.0).backend == "auto"
    monkeypatch.setattr(switching, "Compilation", background.Compilation)
    monkeypatch.setattr(Llvm, "compile_time", lambda self, text: 0.1)
    monkeypatch.setattr(Llvm, "least_compile_time", lambda self, text: 0.1)
    model, seen = four_bar(), []
    for _ in range(2000):
        motion = da.solve_dynamics(model, 0.5, step=0.002, outputs=[0.5])
        seen.append(motion.statistics["backend"])
        if seen[-1] != "VM":
            break
    assert seen[0] == "VM" and seen[-1] in ("VM, then LLVM", "LLVM")
    motion = da.solve_dynamics(model, 0.5, step=0.002, outputs=[0.5])
    assert motion.statistics["backend"] == "LLVM"
    np.testing.assert_array_equal(
        motion.trajectory.y,
        da.solve_dynamics(model, 0.5, step=0.002, outputs=[0.5], backend="vm").trajectory.y,
    )


def test_an_unknown_backend_is_refused_with_the_known_ones():
    with pytest.raises(da.UnsupportedError, match=r"'gpu'.*'auto', 'vm', 'jit', 'c'"):
        run(pendulum(), "gpu")


def test_without_a_compiler_c_names_the_cure(monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(da.UnsupportedError, match=r"no-such-compiler.*install gcc.*backend='jit'"):
        run(pendulum(), "c")


def test_the_compiler_of_a_package_is_found_where_the_system_has_none(monkeypatch):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(c_compiler.shutil, "which", lambda name: None)
    monkeypatch.setattr(c_compiler, "find_spec", lambda name: name)
    monkeypatch.setattr(c_compiler, "_compiler", lambda command: command)
    assert c_compiler.find_compiler() == (sys.executable, "-m", "ziglang", "cc")


@pytest.fixture
def no_llvm(monkeypatch):
    """As if the package were not installed."""
    monkeypatch.setattr(llvm, "find_spec", lambda name: None)
    switching.best_toolchain.cache_clear()
    yield
    switching.best_toolchain.cache_clear()


def test_without_llvm_jit_names_the_cure_and_auto_runs(no_llvm, monkeypatch):
    with pytest.raises(da.UnsupportedError, match=r"pip install llvmlite"):
        run(pendulum(), "jit")
    monkeypatch.setenv("CC", "no-such-compiler")
    motion = run(four_bar(), "auto")
    assert motion.status.success
    assert motion.statistics["backend"] == "VM (neither llvmlite nor a C compiler is installed)"


@pytest.mark.thorough
@needs_compiler
def test_without_llvm_auto_takes_the_compiler(no_llvm):
    motion = run(four_bar(), "auto", step=0.5 / 200_000, outputs=[0.5])
    assert motion.statistics["backend"] == "C"


@pytest.mark.few(1)
@pytest.mark.parametrize("backend", COMPILED)
def test_a_cache_that_cannot_be_written_names_the_cure(backend, tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    monkeypatch.setenv("DALEMBERT_CACHE", str(blocked / "cache"))
    with pytest.raises(da.UnsupportedError, match="DALEMBERT_CACHE"):
        run(pendulum(), backend)
    motion = run(four_bar(), "auto", step=0.5 / 100_000, outputs=[0.5])
    assert motion.statistics["backend"] == "VM"


@pytest.mark.skipif(sys.platform == "win32", reason="a script of the shell")
def test_a_compiler_that_fails_is_quoted(tmp_path, monkeypatch):
    script = tmp_path / "cc"
    script.write_text(
        '#!/bin/sh\n[ "$1" = --version ] && echo fake && exit 0\necho boom >&2; exit 3\n'
    )
    script.chmod(0o755)
    monkeypatch.setenv("CC", str(script))
    with pytest.raises(da.UnsupportedError, match=r"boom.*set CC"):
        run(pendulum(), "c")
    assert not list((tmp_path / "cache").iterdir())
