"""Models as modules: from Python, from the command line, in Node and in the browser."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from browser import browser, missing, visit  # noqa: F401
from test_page_types import compiler  # noqa: F401

import dalembert as da
from dalembert import planar
from dalembert.cli import main
from dalembert.io import load_model_file
from dalembert.io.analyses import make_analysis
from dalembert.io.decisions.responses import make_responses

EXAMPLES = Path(__file__).parents[1] / "examples"
CALLS = """
import * as module from {path};
const {{ values, responses }} = {given};
const {{ time, status, message, ...rows }} = module.simulate(values), done = status === "completed";
const outputs = Object.fromEntries(Object.entries(rows).map(([name, row]) => [name, [...row]]));
const gradients = done ? responses.map((name) => module.gradient(name, values)) : [];
const numbers = done ? responses.map((name) => module.evaluate(name, values)) : [];
const about = {{ name: module.name, parameters: module.parameters, measures: module.measures }};
const answer = {{ time: [...time], status, message, outputs, gradients, numbers, about }};
console.log(JSON.stringify(answer));
"""


@pytest.fixture
def node():
    program = shutil.which("node")
    if program is None:
        missing("node")

    def call(file: Path, values: dict[str, float], responses: list[str]) -> dict:
        given = json.dumps({"values": values, "responses": responses})
        text = CALLS.format(path=json.dumps(file.resolve().as_uri()), given=given)
        script = file.with_name("call.mjs")
        script.write_text(text, encoding="utf-8")
        settings = '{"type": "module"}'
        file.with_name("package.json").write_text(settings, encoding="utf-8")
        done = subprocess.run([program, script], capture_output=True, text=True, check=False)
        assert not done.returncode, done.stderr
        return json.loads(done.stdout)

    return call


def four_bar() -> da.Model:
    system = da.System("four-bar", gravity=(0.0, -9.81))
    l1 = system.parameter("l1", 0.3, "m", bounds=(0.2, 0.4), description="crank */ </script>")
    m = system.parameter("m", 1.5, "kg")
    crank = system.add(planar.Bar("crank", length=l1, mass=m, angle=1.5, angular_velocity=1.0))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=5.0))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    return system.build()


def test_invalid_values_are_refused(node, tmp_path: Path) -> None:
    """With the message of Python; the next call runs again."""
    model = four_bar()
    module = model.module(da.Dynamics(duration=0.1, step=0.01), ["crank.angle"])
    file = module.export(tmp_path)[0]
    with pytest.raises(da.ModelError) as error:
        model.values({"m": -1.0})
    answer = node(file, {"m": -1.0}, [])
    assert (answer["status"], answer["message"]) == ("invalid value", str(error.value))
    assert answer["time"] == [] and answer["outputs"]["crank.angle"] == []
    assert node(file, {"m": 2.0}, [])["status"] == "completed"


MEASURES = ["crank.angle", "A.force.x", "coupler.x + l1", "energy", "balance_error"]
RESPONSES = [
    da.final("crank.angle", name="angle"),
    da.maximum("A.force_norm", name="peak"),
    da.maximum("A.force_norm", smooth=0.02, name="smooth peak"),
    da.at(0.5, "rocker.angle", name="halfway"),
    2 * da.final("rocker.y") - da.minimum("coupler.x") + 1,
]


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "analysis",
    [
        da.Dynamics(duration=1.0, step=0.005),
        da.Dynamics(duration=1.0, outputs=101),
        da.Dynamics(duration=0.5, step=0.01, integrator=da.GeneralizedAlpha()),
    ],
    ids=["fixed", "adaptive", "implicit"],
)
def test_values_and_gradients_equal_those_of_python(analysis, node, tmp_path):
    model, values = four_bar(), {"l1": 0.33, "m": 2.0}
    module = model.module(analysis, MEASURES, RESPONSES)
    file = module.export(tmp_path, name="linkage")[0]
    labels = [response.label for response in RESPONSES]
    answer = node(file, values, labels)
    motion = analysis.run(model, values)
    implicit = analysis.integrator.implicit
    if not np.array_equal(motion.time, answer["time"]):
        motion = motion.at(answer["time"])
    assert answer["status"] == "completed" and answer["message"] == motion.status.message
    for name in MEASURES:
        expected = np.asarray(motion[name])
        size = max(np.abs(expected).max(), 1e-3)
        error = np.abs(np.array(answer["outputs"][name]) - expected).max() / size
        assert error < (1e-7 if implicit else 1e-9), name
    if analysis.outputs is not None:  # extremes of Python lie between the outputs
        return
    gradient = da.sensitivity(motion, RESPONSES)
    for k, response in enumerate(RESPONSES):
        assert answer["numbers"][k] == pytest.approx(da.evaluate(motion, response), rel=1e-7)
        slopes = [answer["gradients"][k][name] for name in values]
        assert slopes == pytest.approx(gradient.values[k], rel=1e-6, abs=1e-6)


def pendulum(driven: bool) -> da.Model:
    system = da.System("pendulum", gravity=(0.0, -9.81))
    length = system.parameter("length", 1.0, "m", bounds=(0.5, 2.0))
    bar = system.add(planar.Bar("bar", length=length, mass=1.0, angle=-1.2 * (not driven)))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    if driven:
        system.add(planar.RotationalDriver("motor", system.ground, bar, 2 * da.t))
    else:
        system.add(planar.TorsionSpring("spring", system.ground, bar, stiffness=2.0))
    return system.build()


@pytest.mark.parametrize(
    ("analysis", "measure", "rel"),
    [
        (da.Kinematics(duration=1.0, outputs=11), "bar.end.vx", 1e-9),
        (da.InverseDynamics(duration=1.0, outputs=11), "motor.effort", 1e-9),
        (da.Equilibrium(), "bar.angle", 1e-8),
        (da.Modal(equilibrium=True), "frequency", 1e-8),
    ],
    ids=["kinematics", "inverse dynamics", "equilibrium", "modes"],
)
def test_other_analyses_are_modules_too(analysis, measure, rel, tmp_path, node):
    model, last = pendulum(hasattr(analysis, "duration")), da.final(measure, name="last")
    file = model.module(analysis, [measure], [last]).export(tmp_path)[0]
    answer = node(file, {"length": 1.3}, ["last"])
    result = analysis.run(model, {"length": 1.3})
    assert answer["status"] == "completed"
    assert answer["outputs"][measure] == pytest.approx(result.values(measure), rel=rel)
    slope = da.sensitivity(result, last).item()
    assert answer["gradients"][0]["length"] == pytest.approx(slope, rel=1e-7)


def test_modes_are_exported_with_frequencies_and_damping_ratios(tmp_path, node, capsys):
    ride = EXAMPLES / "teaching" / "ride.toml"
    assert main(["export", str(ride), "--to", "js", "-o", str(tmp_path), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["measures"] == ["frequency", "damping_ratio"]
    answer = node(tmp_path / "ride.js", {"damper": 2500.0}, ["bounce"])
    model = da.load_model(ride).build()
    modes = da.linearize(model, parameters={"damper": 2500.0})
    for name, values in answer["outputs"].items():
        assert values == pytest.approx(modes.values(name), rel=1e-9), name
    slopes = da.sensitivity(modes, da.at(1, "frequency"))
    assert answer["gradients"][0]["damper"] == pytest.approx(
        slopes.sel(parameter="damper").item(), rel=1e-7
    )


def test_a_module_describes_itself(tmp_path, node):
    module = four_bar().module(da.Dynamics(duration=0.1, step=0.01), ["crank.angle"])
    assert module.code.startswith(b"\0asm") and "step" in module.functions
    assert module.save(tmp_path / "m.wasm").read_bytes() == module.code
    assert repr(module).startswith("<Module 'four-bar': ")
    file, types, _ = module.export(tmp_path)
    about = node(file, {}, [])["about"]
    assert about["name"] == "four-bar" and about["measures"] == {"crank.angle": "rad"}
    assert about["parameters"]["l1"] == {
        "value": 0.3,
        "lower": 0.2,
        "upper": 0.4,
        "unit": "m",
        "description": "crank */ </script>",
    }
    assert about["parameters"]["m"]["upper"] is None
    text = types.read_text(encoding="utf-8")
    assert (
        '  /** crank * / ‹/script>: 0.3 [m], at least 0.2, at most 0.4 */\n  "l1": number;' in text
    )


def test_designs_that_fail_have_a_status(tmp_path, node):
    module = four_bar().module(da.Dynamics(duration=0.1, step=0.01), ["crank.angle"])
    answer = node(module.export(tmp_path)[0], {"l1": 3.0}, [])
    assert answer["status"] == "cannot be assembled" and answer["time"] == []
    assert answer["outputs"] == {"crank.angle": []}


def test_structures_are_not_exported(capsys, tmp_path):
    truss = str(EXAMPLES / "truss.toml")
    assert main(["export", truss, "--measure", "bar_1.force", "-o", str(tmp_path)]) != 0
    assert "cannot be a module: only analyses of mechanisms" in capsys.readouterr().err


def test_hostile_names_of_files(tmp_path):
    module = four_bar().module(da.Dynamics(duration=0.1, step=0.01), ["crank.angle"])
    (file, *_) = module.export(tmp_path / "new" / "folder", name="../a/</b> c")
    assert file == tmp_path / "new" / "folder" / "_a_b_c.js" and file.exists()
    (tmp_path / "file").write_text("")
    with pytest.raises(da.FileError, match="cannot be created"):
        module.export(tmp_path / "file" / "below")


@pytest.mark.parametrize(
    ("measures", "responses", "message"),
    [
        (["A.force"], [], "2 components; take .x, .y or a norm"),
        ([], [], "has no outputs; give measures="),
        (["crank.angel"], [], "crank.angle"),
        ([], [da.at(0.123, "crank.x")], "0.123 is not an output"),
        ([], ["peak"], "'peak' is not a response"),
    ],
)
def test_wrong_outputs_are_refused(measures, responses, message):
    with pytest.raises(da.DalembertError, match=message):
        four_bar().module(da.Dynamics(duration=0.1, step=0.01), measures, responses)


def test_models_that_cannot_be_modules_state_the_reason():
    system = da.System("ball", gravity=(0, -10))
    stone = system.add(planar.Body("stone", mass=1.0, inertia=1.0, position=(0, 1)))
    push = da.where(stone.y < 0.5, 20.0, 0.0)
    system.add(planar.Force("push", stone.center, (0.0, push)))
    analysis = da.Dynamics(duration=1.0)
    with pytest.raises(da.UnsupportedError, match="'ball' cannot be a module: forces switch"):
        system.build().module(analysis, ["stone.x"])
    module = four_bar().module(da.Dynamics(duration=0.1, step=0.01), ["crank.x"])
    with pytest.raises(da.UnsupportedError, match=r"unknown format 'py'.*js"):
        module.export(to="py")


# command line ---------------------------------------------------------------------------------


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "four_bar.toml"
    text = (EXAMPLES / "four_bar.toml").read_text(encoding="utf-8")
    path.write_text(text.replace("duration = 8.0", "duration = 1.0"), encoding="utf-8")
    return path


def test_the_command_exports_plots_traces_and_responses(model, tmp_path, node, capsys):
    assert main(["export", str(model), "--to", "js", "-o", str(tmp_path / "page"), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    shown = ["crank.angle", "rocker.angle", "A.force_norm", "coupler.P.x", "coupler.P.y"]
    assert summary["measures"] == shown and summary["responses"] == ["peak", "angle"]
    assert [Path(path).name for path in summary["files"]] == [
        "four_bar.js",
        "four_bar.d.ts",
        "four_bar.html",
    ]
    answer = node(Path(summary["files"][0]), {"l1": 0.25}, ["peak", "angle"])
    file = load_model_file(model)
    built = file.model()
    motion = make_analysis(file, built, None).run(built, {"l1": 0.25})
    for name in shown:
        assert answer["outputs"][name] == pytest.approx(motion[name].values, rel=1e-9, abs=1e-12)
    for name, response in make_responses(file, built).items():
        value = answer["numbers"][["peak", "angle"].index(name)]
        assert value == pytest.approx(da.evaluate(motion, response), rel=1e-9)


@pytest.mark.thorough
def test_other_outputs_and_wrong_names(model, tmp_path, capsys):
    chosen = ["--measure", "crank.x", "--response", "angle", "--output", str(tmp_path), "--json"]
    assert main(["export", str(model), *chosen]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["measures"] == ["crank.x"] and summary["responses"] == ["angle"]
    assert main(["export", str(model), "--to", "cobol"]) == 2
    assert "unknown format 'cobol'" in capsys.readouterr().err
    assert main(["export", str(model), "--response", "peek"]) == 2
    assert "peak" in capsys.readouterr().err


@pytest.mark.thorough
def test_types_are_those_of_the_module(model, tmp_path, compiler):  # noqa: F811
    folder = tmp_path / "page"
    assert main(["export", str(model), "--output", str(folder)]) == 0
    use = """
        import { evaluate, gradient, parameters, simulate } from "./four_bar.js";
        const result = simulate({ l1: 0.25 }), angle: Float64Array = result["crank.angle"];
        const slope: number = gradient("peak", { l2: 1 }).l1, value: number = evaluate("angle");
        const upper: number | null = parameters.l1.upper;
        // @ts-expect-error
        simulate({ length: 1 });
        // @ts-expect-error
        gradient("peek");
        console.log(angle, slope, value, upper, result.time, result.status);
    """
    (folder / "use.ts").write_text(use, encoding="utf-8")
    options = {"target": "es2022", "module": "esnext", "moduleResolution": "bundler"}
    options |= {"strict": True, "noEmit": True, "lib": ["es2022", "dom"], "types": []}
    settings = json.dumps({"compilerOptions": options, "files": ["use.ts"]})
    (folder / "tsconfig.json").write_text(settings, encoding="utf-8")
    done = subprocess.run([compiler, "-p", folder], capture_output=True, text=True, check=False)
    assert done.stdout == ""


def test_the_example_page_runs_from_a_disk(model, tmp_path, browser):  # noqa: F811
    assert main(["export", str(model), "--output", str(tmp_path)]) == 0
    page = browser.new_page()
    errors: list[str] = []
    requests: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto((tmp_path / "four_bar.html").resolve().as_uri())
    page.wait_for_function("document.getElementById('status').value !== ''")
    text = page.evaluate("document.getElementById('status').value")
    assert text.startswith("401 outputs in ")
    before = page.evaluate("document.querySelector('canvas').toDataURL()")
    first = page.inner_text("#responses")
    assert "peak: " in first and first.count("\n") == 1
    slider = page.locator("input[type=range]").first
    slider.focus()
    slider.press("End")
    assert page.evaluate("document.querySelector('canvas').toDataURL()") != before
    assert page.inner_text("#responses") != first
    page.select_option("select", "A.force_norm")
    assert [url for url in requests if not url.startswith(("file:", "blob:"))] == []
    assert errors == []
    page.close()
