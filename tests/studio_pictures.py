"""Pictures of the studio for its chapter of the documentation.

``PYTHONPATH=$PWD/src:tests python tests/studio_pictures.py docs/gallery`` writes them.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from browser import chromium
from studio_desk import Desk
from studio_runs import running_studio

FOUR_BAR = """format = 1
name = "spatial four-bar"
gravity = [0.0, 0.0, -9.81]

[bodies.bar1]
type = "Bar"
length = 0.2
radius = 0.006
density = 1000
position = [0.1, 0, 0]

[bodies.bar2]
type = "Bar"
length = 0.4
radius = 0.012
density = 1000
position = [0.2, 0.6, 0.2]
rotation = { type = "axis_angle", axis = [0, -1, 0], angle = 1.57079632679 }

[joints.A]
type = "Revolute"
connect = [
  { body = "ground", at = [0, 0, 0], axis = [0, 0, 1] },
  { body = "bar1", at = [-0.1, 0, 0], axis = [0, 0, 1] },
]

[joints.B]
type = "Revolute"
connect = [
  { body = "ground", at = [0.2, 0.6, 0], axis = [1, 0, 0] },
  { body = "bar2", at = [-0.2, 0, 0], axis = [0, 0, -1] },
]

[joints.link1]
type = "RigidLink"
connect = ["bar1.end", "bar2.end"]
length = 0.721110255

[drivers.motor1]
type = "RotationalDriver"
joint = "A"
law = "pi*t"
"""
PLATE = """format = 1
kind = "structure"
name = "bracket"

[meshes.plate]
type = "Triangle6"
thickness = 0.01
modulus = 210e9
poisson = 0.3
density = 7850

[meshes.plate.polygon]
vertices = [[0, 0], [2, 0.5], [2, 0.8], [0, 1.2]]
size = 0.11
holes = [{ center = [0.7, 0.6], radius = 0.22 }]

[[supports]]
nodes = "plate.edge4"

[[loads]]
nodes = "plate.vertex3"
fy = -20000
"""
TUBE = (
    "area = 0.00053721, second_moment_y = 2.1878e-07, second_moment_z = 2.1878e-07, "
    "torsion_constant = 4.3756e-07, modulus = 210e9, shear_modulus = 80.769e9, density = 7850"
)
CORNERS = ((0, 0), (2, 0), (2, 2), (0, 2))
FRAME = "\n".join(
    [
        'format = 1\nkind = "structure"\nname = "frame"\ngravity = [0.0, 0.0, 0.0]\n\n[nodes]',
        *(f"n{k} = [{x}, {y}, 0]\nt{k} = [{x}, {y}, 3]" for k, (x, y) in enumerate(CORNERS)),
        "\n[elements]",
        *(
            f'{name}{k} = {{ type = "SpaceFrame", connect = ["{start}{k}", "t{end}"], {TUBE} }}'
            for k in range(4)
            for name, start, end in (("column", "n", k), ("beam", "t", (k + 1) % 4))
        ),
        '\n[[supports]]\nnodes = ["n0", "n1", "n2", "n3"]',
        '\n[[loads]]\nnodes = "t0"\nfx = 3000\nmz = 500\n',
    ]
)
PICTURES = {
    "studio_space": (FOUR_BAR, "studio.space.select({ section: 'bodies', name: 'bar2' })"),
    "studio_structure": (PLATE, "studio.structure.select([{ section: 'meshes', name: 'plate' }])"),
    "studio_frame": (FRAME, "studio.spaceStructure.select([{ section: 'points', name: 't0' }])"),
}
"""Name of a picture → text of the model, what is selected."""


def main(folder: Path) -> None:
    with (
        tempfile.TemporaryDirectory() as place,
        running_studio(Path(place)) as studio,
        chromium() as browser,
    ):
        page = browser.new_page(viewport={"width": 1300, "height": 770}, reduced_motion="reduce")
        visit = Desk(page)
        page.goto(studio.address)
        visit.until("window.studio?.pictures.shown >= 0")
        visit.settle()
        page.click("text=Open…")
        page.wait_for_selector("dialog img")
        page.wait_for_timeout(500)
        page.screenshot(path=folder / "studio_open.png")
        page.keyboard.press("Escape")
        for name, (text, select) in PICTURES.items():
            visit.show(text)
            visit.js("studio.pictures.page.scene.fit()")
            visit.js(f"{{ {select} }}")
            page.wait_for_timeout(500)
            page.screenshot(path=folder / f"{name}.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
