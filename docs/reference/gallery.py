"""The gallery: examples in categories."""

from __future__ import annotations

import ast
from pathlib import Path

from reference.markdown import markdown

DOCS = Path(__file__).parents[1]
ROOT = DOCS.parent
CATEGORIES: dict[str, tuple[str, str]] = {
    "Linkages, cams and gears": (
        "quick_return_shaper",
        "four_bar slider_crank quick_return_shaper sewing_machine cam_follower geneva_wheel "
        "double_parallelogram flat_four_bars n_four_bar massless_coupler rolling_disc carts "
        "cart_a cart_b cart_c "
        "gait_torques smooth_torque chain_drive excavator four_bar_balancing",
    ),
    "Mechanisms in space": (
        "rssr_four_bar",
        "bicycle bricard bump_steer double_wishbone governor gyroscope heavy_top robot_arm "
        "rssr_four_bar spatial_slider_crank stewart_platform universal_driveline",
    ),
    "Flexible mechanisms": (
        "",
        "compliant_gripper elastic_slider_crank flexible_robot_arm leaf_spring tapered_arm",
    ),
    "Contact and impacts": (
        "",
        "cam_lift_off catenary_cable discs_in_a_box slider_crank_with_play woodpecker",
    ),
    "Structures": ("", "plate truss ten_bar_truss truss_shape marimba_bar mbb_beam tuned_mass"),
    "Design": (
        "path_optimization",
        "catapult four_bar_map four_bar_study identified_arm path_optimization pump_front "
        "gripper lightest_reliable_truss reliable_truss shaper_tolerances smallest_cam "
        "straight_line_synthesis swing_up synthesis_tasks twisting_wing",
    ),
    "Cases of the book, methods side by side": (
        "spring_pendulum",
        "bar_slider_mass body_about_a_point compare_four_bar finite_difference_steps "
        "four_bar_violation oscillator_energy partition_conditioning pendulum_multipliers "
        "slider_and_link slider_link_crank sliding_pendulum spherical_particle "
        "spring_pendulum three_body_system",
    ),
}
"""Of the gallery: title → a moving picture, and its examples."""


def gallery() -> str:
    folder = ROOT / "examples"
    stems = sorted(
        {p.stem for p in folder.glob("*.toml")}
        | {p.stem for p in folder.glob("*.py") if "def main(" in p.read_text(encoding="utf-8")}
    )
    parts = []
    for title, (moving, members) in CATEGORIES.items():
        parts.append(f"## {title}")
        if moving:
            parts.append(f"![{moving.replace('_', ' ')}, moving](gallery/{moving}.gif)")
        parts += [_example(folder, stem) for stem in stems if stem in members.split()]
    known = {stem for _, members in CATEGORIES.values() for stem in members.split()}
    if missing := [stem for stem in stems if stem not in known]:
        raise ValueError(f"the gallery has no category for {', '.join(missing)}")
    return "\n\n".join(parts)


def _example(folder: Path, stem: str) -> str:
    script, model = folder / f"{stem}.py", folder / f"{stem}.toml"
    if script.exists():
        text = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or ""
    else:
        lines = model.read_text(encoding="utf-8").splitlines()
        comments = lines[: next(k for k, line in enumerate(lines) if not line.startswith("#"))]
        text = "\n".join(line.lstrip("# ") for line in comments)
    links = [f"[{p.name}](../examples/{p.name})" for p in (model, script) if p.exists()]
    parts = [f"### {stem.replace('_', ' ')}", markdown(text), ", ".join(links)]
    if (DOCS / "gallery" / f"{stem}.png").exists():
        parts.append(f"![{stem.replace('_', ' ')}](gallery/{stem}.png)")
    return "\n\n".join(parts)
