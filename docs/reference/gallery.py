"""Gallery: a grid of cards for each topic, then the description of each example."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from reference.markdown import markdown

DOCS = Path(__file__).parents[1]
ROOT = DOCS.parent
CATEGORIES: dict[str, tuple[str, str]] = {
    "Linkages, cams and gears": (
        "quick_return_shaper",
        "four_bar slider_crank quick_return_shaper sewing_machine cam_follower geneva_wheel "
        "double_parallelogram flat_four_bars n_four_bar massless_coupler ratchet rolling_disc "
        "carts cart_a cart_b cart_c "
        "gait_torques smooth_torque chain_drive excavator four_bar_balancing jansen_leg",
    ),
    "Spatial mechanisms": (
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
        "cam_lift_off capstan catenary_cable chain_hoist compass_biped crates_and_ball "
        "discs_in_a_box dominoes friction_gripper geneva_drive hopper slider_crank_with_play "
        "tippe_top vibratory_feeder woodpecker",
    ),
    "Control": (
        "",
        "active_suspension cart_pole_lqr computed_torque den_hartog_absorber fmu_control",
    ),
    "Structures": ("", "plate truss ten_bar_truss truss_shape marimba_bar mbb_beam tuned_mass"),
    "Design": (
        "path_optimization",
        "catapult four_bar_map four_bar_study identified_arm path_optimization pump_front "
        "gripper lightest_reliable_truss reliable_truss shaper_tolerances smallest_cam "
        "straight_line_synthesis swing_up synthesis_tasks twisting_wing",
    ),
    "Book examples and comparisons of methods": (
        "spring_pendulum",
        "bar_slider_mass body_about_a_point compare_four_bar finite_difference_steps "
        "four_bar_violation oscillator_energy partition_conditioning pendulum_multipliers "
        "slider_and_link slider_link_crank sliding_pendulum spherical_particle "
        "spring_pendulum three_body_system",
    ),
}
"""Topic → animated picture, and names of examples."""
TITLES = {
    "cart_pole_lqr": "Cart-pole with LQR",
    "mbb_beam": "MBB beam",
    "n_four_bar": "N four-bars",
    "rssr_four_bar": "RSSR four-bar",
    "slider_crank_with_play": "Slider crank with clearance",
}
"""Titles other than the capitalised file name."""
COLUMNS = 3
"""Cards per row."""


def gallery() -> str:
    """All topics, in Markdown."""
    folder = ROOT / "examples"
    stems = sorted(
        {p.stem for p in folder.glob("*.toml")}
        | {p.stem for p in folder.glob("*.py") if "def main(" in p.read_text(encoding="utf-8")}
    )
    parts = []
    for title, (moving, members) in CATEGORIES.items():
        listed = [stem for stem in stems if stem in members.split()]
        parts += [f"## {title}", _cards(folder, listed, moving)]
        parts += [_example(folder, stem) for stem in listed]
    listed = {stem for _, members in CATEGORIES.values() for stem in members.split()}
    if missing := [stem for stem in stems if stem not in listed]:
        raise ValueError(f"the gallery has no category for {', '.join(missing)}")
    return "\n\n".join(parts)


def _cards(folder: Path, stems: list[str], moving: str) -> str:
    """A table of pictures with titles and summaries; the animated picture comes first."""
    order = sorted(stems, key=lambda stem: (stem != moving, not _picture(stem, moving)))
    cards = [_card(folder, stem, moving) for stem in order]
    cards += [" "] * (-len(cards) % COLUMNS)
    rows = [cards[k : k + COLUMNS] for k in range(0, len(cards), COLUMNS)]
    head = [" |" * COLUMNS, "---|" * COLUMNS]
    return "\n".join(f"|{row}" for row in [*head, *("|".join(row) + "|" for row in rows)])


def _card(folder: Path, stem: str, moving: str) -> str:
    title, paragraph = _title(stem), " ".join(_text(folder, stem).split("\n\n")[0].split())
    summary = re.split(r"(?<=\.) ", paragraph)[0]
    link = f"(#{title.lower().replace(' ', '-')})"
    picture = _picture(stem, moving)
    image = f"[![{title}]({picture})]{link}<br>" if picture else ""
    return f" {image}[**{title}**]{link}<br>{markdown(summary).replace('|', chr(92) + '|')} "


def _title(stem: str) -> str:
    return TITLES.get(stem, stem.replace("_", " ").capitalize())


def _picture(stem: str, moving: str = "") -> str:
    """Path of the picture of an example; empty without one."""
    name = f"gallery/{stem}.{'gif' if stem == moving else 'png'}"
    return name if (DOCS / name).exists() else ""


def _text(folder: Path, stem: str) -> str:
    """Docstring of the script, else the comment at the head of the model file."""
    script, model = folder / f"{stem}.py", folder / f"{stem}.toml"
    if script.exists():
        return ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or ""
    lines = model.read_text(encoding="utf-8").splitlines()
    comments = lines[: next(k for k, line in enumerate(lines) if not line.startswith("#"))]
    return "\n".join(line.lstrip("# ") for line in comments)


def _example(folder: Path, stem: str) -> str:
    paths = (folder / f"{stem}.toml", folder / f"{stem}.py")
    links = [f"[{path.name}](../examples/{path.name})" for path in paths if path.exists()]
    title = _title(stem)
    parts = [f"### {title}", markdown(_text(folder, stem)), ", ".join(links)]
    if picture := _picture(stem):
        parts.append(f"![{title}]({picture})")
    return "\n\n".join(parts)
