"""Principal axes of meshes: ``python -m benchmarks.imports.mesh_axes FILE ROOT``.

The tensor of each mesh is computed with a mantissa of 64 bits, and compared with that of the import
and with the product of principal moments and axes in MuJoCo's model. MuJoCo ends its iteration for
the axes as soon as the cosine of a rotation exceeds 1 − 10⁻¹², an angle of 1.4·10⁻⁶.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.io.imports.robots.mesh_inertia import mesh_inertia
from dalembert.io.imports.robots.mjcf.bodies import MjcfBodies
from dalembert.io.imports.robots.mjcf.geometry import mesh_data
from dalembert.io.imports.robots.mjcf.source import MjcfSource
from dalembert.io.imports.robots.reader import Omissions
from dalembert.io.imports.xml.resources import Resources


def main() -> None:
    """Print the largest relative error of a tensor, of all meshes in a file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("root", type=Path)
    arguments = parser.parse_args()
    import mujoco

    bodies = _bodies(arguments.file, arguments.root)
    model: Any = mujoco.MjModel.from_xml_path(str(arguments.file))
    worst = np.zeros(3)
    for name, mesh in bodies.meshes.items():
        kind = mesh.text("inertia", "legacy")
        vertices, faces = mesh_data(mesh, bodies.source)
        if kind not in ("legacy", "exact") or not len(faces):
            continue
        gyration = mesh_inertia(vertices, faces, kind)[2]
        exact = extended_tensor(vertices, faces, kind)
        axes = np.zeros(9)
        mujoco.mju_quat2Mat(axes, model.mesh_quat[model.mesh(name).id])
        axes = axes.reshape(3, 3)
        turned = axes.T @ exact @ axes
        products = np.abs(turned - np.diag(np.diag(turned))).max()
        moments = np.diag(turned)
        angle = products / max(np.ptp(moments), 1e-300)
        errors = [np.abs(gyration - exact).max(), products]
        worst = np.maximum(worst, [*(errors / np.abs(exact).max()), angle])
    print(f"relative error of the import {worst[0]:.0e}, of MuJoCo {worst[1]:.0e}")
    print(f"product of inertia over difference of moments in MuJoCo {worst[2]:.1e}")


def extended_tensor(vertices: np.ndarray, faces: np.ndarray, kind: str) -> np.ndarray:
    """Moments per unit mass about the mass centre, by sums of tetrahedra in extended precision."""
    corners = vertices.astype(np.longdouble)[faces]
    a, b, c = (corners[:, k] for k in range(3))
    normals = np.cross(b - a, c - a) / 2
    areas = np.sqrt((normals**2).sum(axis=1))
    corners = corners - (areas[:, None] * corners.mean(axis=1)).sum(axis=0) / areas.sum()
    volumes = _volumes(corners, kind)
    corners = corners - (volumes[:, None] * corners.sum(axis=1)).sum(axis=0) / volumes.sum() / 4
    volumes = _volumes(corners, kind)
    second = np.zeros((3, 3), dtype=np.longdouble)
    for weight, points in zip(volumes, corners, strict=True):
        total = points.sum(axis=0)
        second += weight * (sum(np.outer(p, p) for p in points) + np.outer(total, total))
    second = second / (20 * volumes.sum())
    tensor: np.ndarray = np.trace(second) * np.eye(3, dtype=np.longdouble) - second
    return tensor


def _volumes(corners: np.ndarray, kind: str) -> np.ndarray:
    a, b, c = (corners[:, k] for k in range(3))
    volumes: np.ndarray = (a * np.cross(b, c)).sum(axis=1) / 6
    return np.abs(volumes) if kind == "legacy" else volumes


def enter_tensors(model: Any, path: Path, root: Path) -> None:
    """Give MuJoCo's model the inertia tensors of the import, with exact principal axes."""
    import mujoco

    links = _bodies(path, root).links
    if len(links) != model.nbody - 1:
        raise ValueError("MuJoCo has other bodies than the import")
    for k, link in enumerate(links, 1):
        if model.body_sameframe[k] or not link.inertia.tensor.any():
            continue
        moments, axes = np.linalg.eigh(link.inertia.tensor)
        axes[:, 0] *= np.sign(np.linalg.det(axes))
        mujoco.mju_mat2Quat(model.body_iquat[k], axes.ravel())
        model.body_inertia[k] = moments


def _bodies(path: Path, root: Path) -> MjcfBodies:
    return MjcfBodies(MjcfSource(path, Resources(path, root, {}), Omissions({})))


if __name__ == "__main__":
    main()
