"""Contact points and contact forces in results, pictures and scenes."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.cli.app import main
from dalembert.report.packing import unpack
from dalembert.results.files.store import report_of
from dalembert.results.pictures.animation import _picture, write_still
from dalembert.results.pictures.scene import motion_scene

contact = planar.contact
G = 9.81


@pytest.fixture(scope="module")
def resting() -> da.Motion:
    """A box and a disc at rest beside a box that falls later."""
    system = da.System("resting", gravity=(0.0, -G))
    box = system.add(planar.Body("box", mass=2.0, inertia=0.1, position=(0.0, 0.1)))
    disc = system.add(planar.Body("disc", mass=1.0, inertia=0.1, position=(1.0, 0.2)))
    late = system.add(planar.Body("late", mass=1.0, inertia=0.1, position=(2.0, 0.12)))
    shapes = [
        contact.Rectangle(box, (0.4, 0.2)),
        contact.Circle(disc, 0.2),
        contact.Rectangle(late, (0.2, 0.2)),
        contact.HalfPlane(system.ground),
    ]
    system.add(planar.Collisions("floor", shapes, friction=0.5))
    return da.solve_nonsmooth(system.build(), 0.2, step=5e-3)


def test_forces_carry_the_weight_where_bodies_touch(resting):
    first, last = resting.contact_forces(0.01), resting.contact_forces(0.2)
    assert sorted(first.places[:, 0].round(6)) == [-0.2, 0.2, 1.0]
    assert sorted(last.places[:, 0].round(6)) == [-0.2, 0.2, 1.0, 1.9, 2.1]
    assert last.places[:, 1] == pytest.approx(0.0, abs=1e-9)
    assert set(last.names) == {"floor"}
    settled = last.places[:, 0] < 1.5  # the box that fell has a residual speed below g h/2
    assert last.forces[settled].sum(axis=0) == pytest.approx([0.0, 3 * G], abs=1e-6)
    moments = last.places[settled, 0] * last.forces[settled, 1]
    assert moments.sum() == pytest.approx(G * 1.0, abs=1e-6)


def test_scenes_have_columns_of_contacts(resting):
    rows = np.array([2, 20, 40])
    scene = motion_scene(resting, rows)
    contacts = [joint for joint in scene["joints"] if joint["symbol"] == "contact"]
    assert len(contacts) == 5
    places = np.array([[c["at_x"], c["at_y"]] for c in contacts])
    forces = np.array([[c["force_x"], c["force_y"]] for c in contacts])
    used = np.isfinite(places[:, 0])
    counts = used.sum(axis=0)
    assert counts[0] == 3 and counts[1:].min() >= 4
    assert (used == np.isfinite(forces[:, 1])).all()
    held = places[used[:, 0], 0]
    assert held == pytest.approx(np.tile(held[:, :1], 3), abs=1e-9)  # each keeps its symbol


def test_pictures_draw_contact_forces(resting):
    axes = resting.draw(0.2)
    lines = [line for line in axes.lines if line.get_color() == "#c00000"]
    assert len(lines) == 5
    heights = [np.ptp(line.get_ydata()) for line in lines]
    assert max(heights) > 0.05


def test_motions_without_contacts_have_none():
    system = da.System("free")
    system.add(planar.Body("b", mass=1.0, inertia=1.0))
    motion = da.solve_dynamics(system.build(), 0.1, step=0.1)
    assert motion.drawn_contacts(0) is None


def test_films_show_the_contacts_of_their_instants(resting, tmp_path):
    """Fewer frames than outputs: contact points lie where those of the output nearest to it do."""
    resting.save(tmp_path / "resting.nc")
    page = report_of(da.load_results(tmp_path / "resting.nc"))
    picture, count = _picture(unpack(page), 5, None)
    assert count == 5 < resting.time.size
    for k, time in enumerate(np.linspace(0, 0.2, 5)):
        drawn = np.array([points[k, 0] for _, points in picture.forces])
        drawn = drawn[np.isfinite(drawn[:, 0])]
        places = resting.contact_forces(time).places
        assert sorted(drawn[:, 0]) == pytest.approx(sorted(places[:, 0]), abs=1e-6)
    plt.close(picture.ax.figure)


def test_surfaces_of_many_triangles_have_stills(tmp_path):
    """Pages pack long lists; the numbers of vertices of a surface remain whole."""
    system = da.System("field", gravity=(0, 0, -G))
    ball = system.add(spatial.Body("ball", mass=1.0, inertia=(0.1,) * 3, position=(0, 0, 0.2)))
    hills = 0.01 * np.sin(np.arange(121.0)).reshape(11, 11)
    field = spatial.contact.HeightField(system.ground.frame(), (1.0, 1.0), hills)
    shapes = [spatial.contact.Sphere(ball.center, 0.1), field]
    system.add(spatial.Collisions("contacts", shapes))
    motion = da.solve_nonsmooth(system.build(), 0.02, step=1e-2)
    motion.save(tmp_path / "field.nc")
    write_still(report_of(da.load_results(tmp_path / "field.nc")), tmp_path / "field.png")
    assert (tmp_path / "field.png").stat().st_size > 1000


@pytest.mark.thorough
def test_films_of_files_have_contact_forces(resting, tmp_path):
    """Files have no numbers where a symbol is unused."""
    resting.save(tmp_path / "resting.nc")
    code = main(["film", str(tmp_path / "resting.nc"), "--fps", "5", "--seconds", "1"])
    assert not code and (tmp_path / "resting.gif").stat().st_size > 1000


def test_half_spaces_are_floors_of_the_size_of_the_motion():
    """A rectangle in the plane, visible from outside, about the places over it."""
    system = da.System("floor", gravity=(0.0, 0.0, -G))
    shapes = []
    for k, (x, y) in enumerate([(-1.0, 0.5), (2.0, 0.0)]):
        ball = spatial.Sphere(f"b{k}", radius=0.1, mass=1.0, position=(x, y, 0.1))
        shapes.append(spatial.contact.Sphere(system.add(ball), 0.1))
    axes = system.ground.frame((0, 0, 0), axis=(0, 0, 1))
    system.add(spatial.Collisions("touch", [*shapes, spatial.contact.HalfSpace(axes)]))
    motion = da.solve_nonsmooth(system.build(), 0.02, step=5e-3)
    scene = motion_scene(motion, np.array([0, 4]))
    (floor,) = (shape for shape in scene["ground"]["shapes"] if shape["kind"] == "mesh")
    places = np.reshape(floor["vertices"], (-1, 3))
    assert places[:, 2] == pytest.approx(0.0)
    low, high = places.min(axis=0), places.max(axis=0)
    assert low[0] < -1.0 and high[0] > 2.0 and low[1] < 0.0 and high[1] > 0.5
    assert high[0] - low[0] < 4.5
    first, second, third = places[floor["faces"][:3]]
    assert np.cross(second - first, third - second)[2] > 0
    assert motion.draw().lines
