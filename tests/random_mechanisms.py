"""Random planar mechanisms, each with a twin of its mechanics in plain NumPy.

Poses come first, then joints that fit them, so that every mechanism can be assembled.
"""

from __future__ import annotations

import numpy as np
from mechanism_twin import direction_at, direction_of
from random_forces import Mechanism
from twins import left, turn

import dalembert as da


def empty(rng: np.random.Generator) -> Mechanism:
    weight = rng.choice([0.0, 9.81]) * direction_of(rng)
    gravity = tuple(weight) if weight.any() else None
    return Mechanism(rng, da.System("random", gravity=gravity), weight)


def chain(m: Mechanism, count: int) -> int:
    """Bodies joined to earlier ones or the ground at random; the freedoms left."""
    freedom = 0
    for k in range(count):
        particle = m.rng.random() < 0.1
        name = m.particle() if particle else m.body()
        freedom += 2 if particle else 3
        earlier = ["ground", *[n for n in m.bodies if n not in ("ground", name)]]
        if k or m.rng.random() < 0.8:
            freedom -= m.any_joint(str(m.rng.choice(earlier)), name)
    return freedom


def opened(m: Mechanism) -> None:
    chain(m, int(m.rng.integers(1, 4)))


def closed(m: Mechanism) -> None:
    """Further joints as long as something stays free, or nothing."""
    freedom = chain(m, int(m.rng.integers(2, 4)))
    names = list(m.bodies)
    least = int(m.rng.choice([0, 1, 1, 1]))
    for _ in range(4):
        i, j = (str(name) for name in m.rng.choice(names, 2, replace=False))
        if m.bodies[i] is m.system.ground or m.turns(i):
            if freedom >= 2 + least and m.turns(j) and m.rng.random() < 0.7:
                if m.rng.random() < 0.6:
                    m.revolute(i, j, m.place())
                else:
                    m.slider(i, j, m.place(), m.place())
                freedom -= 2
            elif freedom >= 1 + least:
                m.link(i, j, m.at(i), m.at(j))
                freedom -= 1


def trammel(m: Mechanism) -> None:
    """A bar with two pins in crossing slots, and a crank about its circle's centre: redundant."""
    rng = m.rng
    tilt, half, phi = rng.uniform(-3, 3), rng.uniform(0.3, 0.7), rng.uniform(-3, 3)
    centre, u = m.place() / 2, direction_at(tilt)
    w = left(u)
    middle = centre + half * turn(tilt, direction_at(phi))
    bar = m.body(np.append(middle, rng.uniform(-3, 3)))

    def guide(axis, end):
        if rng.random() < 0.3:
            m.slot("ground", bar, centre - axis, end)
        else:
            shoe = m.body(np.append(end, 0.3))
            m.slider("ground", shoe, centre - axis, end)
            m.revolute(shoe, bar, end)

    def crank():
        if rng.random() < 0.5:
            m.link("ground", bar, centre, middle)
        else:
            arm = m.body(np.append((centre + middle) / 2, 0.1))
            m.revolute("ground", arm, centre)
            m.revolute(arm, bar, middle)

    parts = (
        lambda: guide(u, centre + 2 * half * np.cos(phi) * u),
        lambda: guide(w, centre + 2 * half * np.sin(phi) * w),
        crank,
    )
    for k in rng.permutation(3):
        parts[k]()


def parallelogram(m: Mechanism) -> None:
    """A platform on three or four parallel cranks or links of one length."""
    rng = m.rng
    arm = rng.uniform(0.3, 0.8) * direction_of(rng)
    platform = m.body()
    for _ in range(int(rng.integers(3, 5))):
        foot = m.place()
        if rng.random() < 0.5:
            m.link("ground", platform, foot, foot + arm)
        else:
            crank = m.body(np.append(foot + arm / 2, rng.uniform(-3, 3)))
            m.revolute("ground", crank, foot)
            m.revolute(crank, platform, foot + arm)


def doubled(m: Mechanism) -> None:
    """A chain, some of whose joints are held twice."""
    rng, carrier = m.rng, "ground"
    for _ in range(int(rng.integers(1, 4))):
        body, a = m.body(), m.place()
        b, pick = m.place(), rng.integers(5)
        far = a + rng.uniform(0.3, 1) * direction_of(rng)
        if pick == 0:  # a pin, and a link or a slot that says the same
            m.revolute(carrier, body, a)
            if rng.random() < 0.5:
                m.link(carrier, body, far, a)
            else:
                m.slot(body, carrier, far, a)
        elif pick == 1:
            m.revolute(carrier, body, a)
            m.revolute(carrier, body, a)
        elif pick == 2:
            m.slider(carrier, body, a, b)
            m.slot(carrier, body, far, far + (b - a))
        elif pick == 3:
            m.weld(carrier, body, a)
            m.link(carrier, body, b, far)
        else:
            m.slider(carrier, body, a, b)
            m.slider(carrier, body, far, far + 2 * (b - a))
        carrier = body


def held(m: Mechanism) -> None:
    """Massless members between others: welded on, or a coupler with two pins."""
    rng = m.rng
    first = m.body()
    m.revolute("ground", first, m.place())
    if rng.random() < 0.5:
        tool = m.body(massless=True)
        m.weld(first, tool, m.place())
        return
    second, coupler = m.body(), m.body(massless=True)
    m.revolute("ground", second, m.place())
    m.revolute(first, coupler, m.place())
    m.revolute(coupler, second, m.place())


def geared(m: Mechanism) -> None:
    """A rolling wheel, something on it, and perhaps a wheel that is coupled to it."""
    rng, wheel, other = m.rng, m.body(), m.body()
    m.rolling(wheel)
    m.any_joint(wheel, other)
    if rng.random() < 0.5:
        third = m.body()
        m.revolute("ground", third, m.place())
        m.coupling(wheel, third, float(rng.choice([-2.0, 0.5])))


def planetary(m: Mechanism) -> None:
    """Two wheels on an arm or on the ground, geared or coupled, perhaps one on a rack."""
    rng, carrier, a, b = m.rng, "ground", m.place(), m.place()
    if rng.random() < 0.6:
        carrier = m.body()
        m.revolute("ground", carrier, a)
    sun, planet = m.body(), m.body()
    m.revolute("ground" if rng.random() < 0.5 else carrier, sun, a)
    m.revolute(carrier, planet, b)
    if rng.random() < 0.6:
        m.gears(sun, planet, a, b)
    else:
        m.coupling(sun, planet, rng.uniform(-2, 2), None if carrier == "ground" else carrier)
    if rng.random() < 0.4:
        rack = m.body()
        m.slider("ground", rack, m.place(), m.place())
        m.rack(rack, planet, m.place(), b)


def cam(m: Mechanism) -> None:
    """A disc about a pin and what follows its rim: a lever, a tappet, or a particle."""
    disc, pick = m.body(), m.rng.integers(3)
    m.revolute("ground", disc, m.place())
    follower = m.particle() if pick == 0 else m.body()
    if pick == 1:
        m.revolute("ground", follower, m.place())
    elif pick == 2:
        m.slider("ground", follower, m.place(), m.place())
    m.curve(disc, follower, m.at(follower))


KINDS = (opened, closed, trammel, parallelogram, doubled, held, geared, planetary, cam)


def random_mechanism(seed: int) -> tuple[str, Mechanism]:
    """A mechanism of a random kind, with drivers and loads; the same for the same seed."""
    rng = np.random.default_rng(seed)
    make, m = KINDS[rng.integers(len(KINDS))], empty(rng)
    make(m)
    names = list(m.bodies)

    def pair() -> tuple[str, str]:
        i, j = (str(name) for name in rng.choice(names, 2, replace=False))
        return (j, i) if j == "ground" else (i, j)

    for _ in range(int(rng.integers(0, 3))):
        m.any_force(*pair())
    if rng.random() < 0.2:
        m.driver(*pair())
    rng = m.rng = np.random.default_rng((seed, 1))  # so that all else stays as it was
    if rng.random() < 0.2:
        m.any_touch(*pair())
    rng = m.rng = np.random.default_rng((seed, 2))
    if rng.random() < 0.1:
        m.beam(*pair())
    elif rng.random() < 0.1:
        m.unilateral(pair()[1])
    return make.__name__, m
