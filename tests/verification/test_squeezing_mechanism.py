"""Andrews' squeezing mechanism: seven bodies, three loops, milliseconds.

Source: E. Hairer and G. Wanner, *Solving Ordinary Differential Equations II*, section VII.7, and
the Test Set for IVP Solvers: data, initial values and the solution at t = 0.03 s.
"""

import pytest

import dalembert as da
from dalembert import planar

XA, YA, XB, YB, XC, YC = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
D, DA, E, EA, ZF, FA, RR, RA = 28e-3, 115e-4, 2e-2, 1421e-5, 2e-2, 1421e-5, 7e-3, 92e-5
SS, SA, SB, SC, SD = 35e-3, 1874e-5, 1043e-5, 18e-3, 2e-2
ZT, TA, TB, U, UA, UB = 4e-2, 2308e-5, 916e-5, 4e-2, 1228e-5, 449e-5
STIFFNESS, FREE_LENGTH, TORQUE = 4530.0, 0.07785, 0.033

BETA, GAMMA = -0.0617138900142764496358948458001, 0.455279819163070380255912382449
PHI, DELTA = 0.222668390165885884674473185609, 0.487364979543842550225598953530
OMEGA, EPSILON = -PHI, 1.23054744454982119249735015568

SOLUTION = {
    "k1.angle": 15.81077119629904,
    "k2.angle - k1.angle": -15.75637105984298,
    "k3.angle": 0.04082224013073101,
    "k4.angle - k5.angle": -0.5347301163226948,
    "k5.angle": 0.5244099658805304,
    "k6.angle - k7.angle": 0.5347301163226948,
    "k7.angle": 1.048080741042263,
}


def squeezer() -> da.Model:
    """Body frames follow the source: each body's angle is the source's coordinate."""
    system = da.System("squeezing_mechanism")

    def body(name: str, mass: float, inertia: float, angle: float) -> planar.Body:
        return system.add(planar.Body(name, mass=mass, inertia=inertia, angle=angle))

    k1 = body("k1", 0.04325, 2.194e-6, BETA)
    k2 = body("k2", 0.00365, 4.410e-7, BETA)
    k3 = body("k3", 0.02373, 5.255e-6, GAMMA)
    k4 = body("k4", 0.00706, 5.667e-7, PHI + DELTA)
    k5 = body("k5", 0.07050, 1.169e-5, DELTA)
    k6 = body("k6", 0.00706, 5.667e-7, OMEGA + EPSILON)
    k7 = body("k7", 0.05498, 1.912e-5, EPSILON)
    a, b, c = (system.ground.point(*p) for p in ((XA, YA), (XB, YB), (XC, YC)))
    # points by their distance from the mass centre, in the axes of each body
    pins = {
        "o": (system.ground.center, k1.point(-RA, 0)),
        "f": (k1.point(RR - RA, 0), k2.point(DA, 0)),
        "b": (b, k3.point(-SB, SA)),
        "e3": (k2.point(DA - D, 0), k3.point(-SB, SA - SS)),
        "e4": (k2.point(DA - D, 0), k4.point(0, -EA)),
        "e6": (k2.point(DA - D, 0), k6.point(FA, 0)),
        "a5": (a, k5.point(-TA, -TB)),
        "g": (k5.point(ZT - TA, -TB), k4.point(0, E - EA)),
        "a7": (a, k7.point(UB, UA)),
        "h": (k7.point(UB, UA - U), k6.point(FA - ZF, 0)),
    }
    for name, (i, j) in pins.items():
        system.add(planar.Revolute(name, i, j))
    spring = k3.point(SD - SB, SA - SC)
    system.add(planar.Spring("spring", c, spring, stiffness=STIFFNESS, free_length=FREE_LENGTH))
    system.add(planar.Torque("motor", k1, TORQUE))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("formulation", [da.RangeSpace(), da.KKT()])
def test_angles_after_thirty_milliseconds(formulation):
    model = squeezer()
    assert model.diagnosis.degrees_of_freedom == 1
    motion = da.solve_dynamics(
        model,
        0.03,
        outputs=[0.03],
        formulation=formulation,
        integrator=da.DormandPrince(rtol=1e-11, atol=1e-12),
    )
    assert motion.status.success
    for measure, value in SOLUTION.items():
        assert motion[measure].values[-1] == pytest.approx(value, abs=2e-8), measure
    assert float(motion.data["position_violation"].max()) <= 1e-12
