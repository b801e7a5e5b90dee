"""Optimisation of live pages: minima with bounds, limits and failing designs, run in Node."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest
from browser import missing

ASSETS = Path(__file__).parents[1] / "src/dalembert/report/assets"

PROBLEMS = {
    # f, ∇f, c, ∇c, minimum in [0, 1]ⁿ
    "concave": (
        "-(x[0]**2) - 0.3*x[1]**2 - 0.1*x[0]*x[2]",
        "[-2*x[0] - 0.1*x[2], -0.6*x[1], -0.1*x[0]]",
        "[]",
        "[]",
        -1.4,
    ),
    "linear": ("x[0] + 0.3*x[1] - 0.1*x[2]", "[1, 0.3, -0.1]", "[]", "[]", -0.1),
    "Rosenbrock": (
        "100*(4*x[1] - 2 - (4*x[0] - 2)**2)**2 + (3 - 4*x[0])**2",
        "[-1600*(4*x[0] - 2)*(4*x[1] - 2 - (4*x[0] - 2)**2) - 8*(3 - 4*x[0]), "
        "800*(4*x[1] - 2 - (4*x[0] - 2)**2)]",
        "[]",
        "[]",
        0.0,
    ),
    "circle": (
        "(x[0] - 2)**2 + (x[1] - 1)**2",
        "[2*(x[0] - 2), 2*(x[1] - 1)]",
        "[x[0]**2 + x[1]**2 - 1]",
        "[[2*x[0], 2*x[1]]]",
        (5**0.5 - 1) ** 2,
    ),
    "two limits": (
        "x[0] + x[1]",
        "[1, 1]",
        "[0.5 - x[0]*x[1] - x[0], 0.2 - x[1]]",
        "[[-x[1] - 1, -x[0]], [0, -1]]",
        0.5 / 1.2 + 0.2,
    ),
}


def minimise(folder: Path, f: str, df: str, c: str, dc: str, start: list[float]) -> dict:
    node = shutil.which("node") or missing("node")
    for name in ("live_optimizer.js", "live_matrix.js"):
        shutil.copy(ASSETS / name, folder / name)
    (folder / "package.json").write_text('{"type": "module"}')
    (folder / "run.js").write_text(
        f"""
        import {{ minimised }} from "./live_optimizer.js";
        const evaluate = async (x) => {{
            const at = {{ f: {f}, df: {df}, c: {c}, dc: {dc} }};
            return Number.isFinite(at.f) ? at : null;
        }};
        let last;
        const end = await minimised({json.dumps(start)}, evaluate,
            async (iterate) => {{ last = iterate; }}, () => false);
        console.log(JSON.stringify({{ ...end, x: last?.x, f: last?.at.f }}));
        """
    )
    command = [node, str(folder / "run.js")]
    run = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    return json.loads(run.stdout)


@pytest.mark.few(5)
@pytest.mark.parametrize("start", [0.4, 0.05, 0.9])
@pytest.mark.parametrize("name", PROBLEMS)
def test_minima_within_bounds_and_limits(tmp_path: Path, name: str, start: float) -> None:
    f, df, c, dc, minimum = PROBLEMS[name]
    variables = 1 + max(k for k in range(3) if f"x[{k}]" in f)
    end = minimise(tmp_path, f, df, c, dc, [start, 1 - start, start / 2][:variables])
    assert end["outcome"] == "converged"
    assert end["f"] == pytest.approx(minimum, abs=2e-6)
    assert all(0 <= x <= 1 for x in end["x"])


def test_limits_that_cannot_be_satisfied(tmp_path: Path) -> None:
    end = minimise(tmp_path, "x[0]", "[1, 0]", "[2 - x[0] - 0.1*x[1]]", "[[-1, -0.1]]", [0.4, 0.3])
    assert end["outcome"] == "infeasible"
    assert end["x"] == pytest.approx([1, 1])  # the violation is as small as possible


def test_designs_that_fail_narrow_the_steps(tmp_path: Path) -> None:
    end = minimise(tmp_path, "x[0] < 0.3 ? NaN : x[0]", "[1]", "[]", "[]", [0.9])
    assert end["outcome"] == "failed designs"
    assert end["failures"] > 3
    assert 0.3 <= end["x"][0] < 0.3 + 1e-6


def test_a_kink_is_not_called_converged(tmp_path: Path) -> None:
    f, df = "Math.abs(x[0] - 0.61803)", "[Math.sign(x[0] - 0.61803)]"
    end = minimise(tmp_path, f, df, "[]", "[]", [0.1])
    assert end["outcome"] == "no progress"
    assert end["x"][0] == pytest.approx(0.61803, abs=1e-5)
