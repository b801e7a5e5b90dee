"""Momentum and energy of random chains and loops afloat in space, whatever ties their links."""

from __future__ import annotations

import itertools

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from spatial_trees import SpatialTree
from thorough import sampled

import dalembert as da
from dalembert import spatial
from dalembert.elements.spatial.inertia_tensor import tensor
from dalembert.symbolic.formulas.expression import Expression

LINKS = 4
IN_LOOPS = ["Revolute", "Cylindrical", "Universal", "Spherical", "Screw", "Prismatic", "Planar"]
JOINTS = [spatial.Spherical, spatial.Revolute, spatial.Cylindrical, spatial.Universal, None]


def chain(seed: int) -> da.Model:
    """Boxes with mass centres anywhere on random joints and bushings, with a spring."""
    rng = np.random.default_rng(seed)
    system = da.System("chain")
    bodies = []
    for k in range(LINKS):
        bodies.append(
            spatial.Box(
                f"b{k}",
                size=rng.uniform(0.3, 0.6, 3),
                mass=rng.uniform(0.5, 2.0),
                center_of_mass=0.1 * rng.standard_normal(3),
                position=(k, 0.2 * rng.standard_normal(), 0.2 * rng.standard_normal()),
                rotation=Rotation.random(random_state=rng),
                velocity=0.3 * rng.standard_normal(3),
                angular_velocity=rng.standard_normal(3),
            )
        )
        system.add(bodies[-1])
    for k, (i, j) in enumerate(itertools.pairwise(bodies)):
        places = 0.5 * rng.standard_normal((2, 3))
        ends = [
            b.frame(place, axis=rng.standard_normal(3))
            for b, place in zip((i, j), places, strict=True)
        ]
        kind = JOINTS[rng.integers(len(JOINTS))]
        if kind is None:
            along, about = rng.uniform(20, 40, 3), rng.uniform(2, 4, 3)
            tie = spatial.Bushing(f"J{k}", *ends, stiffness=along, rotational_stiffness=about)
        else:
            tie = kind(f"J{k}", *ends)
        system.add(tie)
    spring = {"stiffness": 30.0, "free_length": 0.4}
    system.add(spatial.Spring("spring", bodies[0].center, bodies[-1].center, **spring))
    return system.build()


def loop(seed: int) -> da.Model:
    """Bodies in a ring of random joints, the last one closed by a ball, with a spring across."""
    ring = SpatialTree(seed, gravity=None)
    names = [ring.body() for _ in range(LINKS)]
    for i, j in itertools.pairwise(names):
        ring.joint(str(ring.rng.choice(IN_LOOPS)), i, j)
    ring.joint("Spherical", names[-1], names[0])
    ends = (ring.places[k][0].center for k in (names[0], names[LINKS // 2]))
    ring.system.add(spatial.Spring("spring", *ends, stiffness=30.0, free_length=0.4))
    return ring.system.build()


def momenta(model: da.Model) -> Expression:
    """``Σ m v, Σ r × m v + J ω``."""
    linear, angular = ca.SX.zeros(3), ca.SX.zeros(3)
    for body in model.bodies:
        push = body.mass.sx * body.twist[:3]
        spin = ca.mtimes([body.axes, tensor(body.inertia.sx), body.twist[3:]])
        linear, angular = linear + push, angular + ca.cross(body.pose[:3], push) + spin
    return Expression(ca.vertcat(linear, angular))


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("mechanism", "seed"),
    sampled([*((chain, k) for k in range(6)), *((loop, k) for k in range(4))], 3),
)
def test_floating_mechanisms_conserve_momentum_and_energy(mechanism, seed):
    model = mechanism(seed)
    assert len(model.diagnosis.topology.loops) == (mechanism is loop)
    motion = da.solve_dynamics(model, 0.2, integrator=da.DormandPrince853(1e-10, 1e-11), outputs=5)
    assert motion.status.success
    computed = np.asarray(motion.values(momenta(model)))
    assert np.abs(computed - computed[0]).max() < 1e-9 * (1 + np.abs(computed).max())
    kinetic = np.asarray(motion["kinetic_energy"])
    energy = kinetic + np.asarray(motion["potential_energy"])
    assert np.ptp(kinetic) > 1e-2
    assert np.ptp(energy) < 1e-8 * np.abs(energy).max()
