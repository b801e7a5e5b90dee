"""VTK series, read back by meshio."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as xml

import meshio
import numpy as np
import pytest
from meshio._vtk_common import meshio_to_vtk_type
from registry import CASES, model_of

import dalembert as da
from dalembert import planar
from dalembert.elements.fem.registry import ELEMENTS, cell_of
from dalembert.io.exports.registry import FORMATS

EXAMPLES = Path(__file__).parents[1] / "examples"


def series(path: Path) -> list[tuple[float, str, meshio.Mesh]]:
    """Time, name and grid of each entry of a collection."""
    rows = xml.parse(path).getroot().iter("DataSet")
    return [
        (float(r.get("timestep")), r.get("name"), meshio.read(path.with_name(r.get("file"))))
        for r in rows
    ]


def four_bar() -> da.Model:
    return da.load_model(EXAMPLES / "four_bar.toml").build()


def test_bodies_move_with_their_velocities_and_joints_have_reactions(tmp_path):
    model = four_bar()
    motion = da.solve_dynamics(model, 0.5, step=0.01, outputs=6)
    entries = series(da.export(motion, tmp_path / "bar.pvd").files[0])
    assert [name for _, name, _ in entries] == ["bodies", "joints"] * motion.time.size
    times = [time for time, name, _ in entries if name == "bodies"]
    np.testing.assert_array_equal(times, motion.time)
    crank = 1 + [body.name for body in model.bodies].index("crank")
    bodies = [mesh for _, name, mesh in entries if name == "bodies"]
    for k, mesh in enumerate(bodies):
        triangles = mesh.cells_dict["triangle"]
        own = np.unique(triangles[mesh.cell_data_dict["body"]["triangle"] == crank])
        arms = mesh.points[own, :2] - motion["crank.position"].values[k]
        spin = motion["crank.angular_velocity"].values[k]
        expected = motion["crank.velocity"].values[k] + spin * np.column_stack(
            [-arms[:, 1], arms[:, 0]]
        )
        np.testing.assert_allclose(mesh.point_data["velocity"][own, :2], expected, atol=1e-12)
    joints = [mesh for _, name, mesh in entries if name == "joints"]
    names = motion.data["joint"].values.tolist()
    forces = motion.data["reaction_force"].values
    for k, mesh in enumerate(joints):
        written = mesh.point_data["reaction_force"][:, :2]
        np.testing.assert_array_equal(written[names.index("A")], forces[k, names.index("A")])


def test_rigid_motion_keeps_lengths(tmp_path):
    motion = da.solve_dynamics(four_bar(), 0.5, step=0.01, outputs=3)
    entries = series(da.export(motion, tmp_path / "bar.pvd").files[0])
    first, *_, last = [mesh for _, name, mesh in entries if name == "bodies"]
    for mesh in (first, last):
        edges = mesh.points[first.cells_dict["triangle"]]
        sizes = np.linalg.norm(edges[:, 0] - edges[:, 1], axis=1)
        reference = first.points[first.cells_dict["triangle"]]
        np.testing.assert_allclose(
            sizes, np.linalg.norm(reference[:, 0] - reference[:, 1], axis=1), atol=1e-12
        )


def test_structures_have_displacements_forces_and_fields(tmp_path):
    model = da.load_model(EXAMPLES / "plate.toml").build()
    result = da.solve_statics(model)
    ((time, name, mesh),) = series(da.export(result, tmp_path / "plate.pvd").files[0])
    assert (time, name) == (0.0, "elements")
    table = model.degrees.table[:, :2]
    np.testing.assert_array_equal(
        mesh.point_data["displacement"][:, :2], result.displacements[table, 0]
    )
    stress = np.concatenate(mesh.cell_data["von_mises"])
    np.testing.assert_array_equal(stress, result.field("plate.von_mises"))
    modes = da.solve_modes(model)
    assert len(series(da.export(modes, tmp_path / "modes.pvd").files[0])) == len(modes.numbers)


def test_motions_of_structures_have_velocities(tmp_path):
    model = da.load_model(EXAMPLES / "plate.toml").build()
    motion = da.solve_transient(model, 1e-3, step=2e-4)
    entries = series(da.export(motion, tmp_path / "plate.pvd").files[0])
    np.testing.assert_allclose([time for time, *_ in entries], motion.time)
    table = model.degrees.table[:, :2]
    for k, (_, _, mesh) in enumerate(entries):
        np.testing.assert_array_equal(
            mesh.point_data["velocity"][:, :2], motion.velocities[table, k]
        )


@pytest.mark.parametrize("name", ELEMENTS)
def test_every_element_has_a_cell_of_vtk(name):
    assert cell_of(ELEMENTS[name]) in meshio_to_vtk_type


def test_modes_of_mechanisms_oscillate_about_the_rest(tmp_path):
    modes = da.linearize(four_bar())
    entries = series(da.export(modes, tmp_path / "modes.pvd").files[0])
    meshes = [mesh for time, _, mesh in entries if time < 1]
    mean = np.mean([mesh.points for mesh in meshes], axis=0)
    moved = max(np.abs(mesh.points - mean).max() for mesh in meshes)
    assert moved > 1e-3


@pytest.mark.few(10)
@pytest.mark.parametrize("name", CASES)
def test_every_case_has_a_grid(name):
    motion = da.solve_dynamics(model_of(name), 0.01, step=0.01)
    assert "m_bodies_0000.vtu" in FORMATS["vtk"].create(motion, "m", {}).files


def test_links_have_the_length_between_their_ends(tmp_path):
    system = da.System("scale", gravity=(0, -10))
    pan = system.add(planar.Particle("pan", mass=2.0, position=(0, -0.1)))
    system.add(planar.Spring("spring", system.ground.center, pan.center, stiffness=100.0))
    motion = da.solve_dynamics(system.build(), 0.2, step=0.01)
    entries = series(da.export(motion, tmp_path / "s.pvd").files[0])
    mesh = [m for _, name, m in entries if name == "bodies"][-1]
    number = mesh.cell_data_dict["body"]["triangle"]
    own = np.unique(mesh.cells_dict["triangle"][number == number.max()])
    np.testing.assert_allclose(mesh.points[own, 1].min(), motion["pan.y"][-1], atol=1e-12)
