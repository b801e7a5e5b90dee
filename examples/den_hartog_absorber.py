"""Vibration absorbers of a machine: Den Hartog's rules, and the exact optima by gradients.

A machine of 100 kg on undamped springs has an absorber of 5 % of its mass. Its spring and damper
are tuned for the lowest resonance peak, by two peaks below a common bound, and for the smallest
root mean square under a force of white noise. Both optima have closed forms: Nishihara and Asami
(Journal of Vibration and Acoustics 124, 2002), Crandall and Mark (Random Vibration in Mechanical
Systems, 1963) and Warburton (Earthquake Engineering and Structural Dynamics 10, 1982). Den Hartog's
rules (Mechanical Vibrations, 1956) are close to the first.
"""

import math
import sys

import matplotlib.pyplot as plt
import numpy as np
import style

import dalembert as da
from dalembert import planar

MASS, SHARE, OMEGA = 100.0, 0.05, 2 * math.pi * 5.0
ADDED = SHARE * MASS
SUPPORT = MASS * OMEGA**2
SPAN = (3.0, 8.0)


def build() -> da.System:
    system = da.System("machine with an absorber")
    push = system.input("push", unit="N")
    stiffness = system.parameter("stiffness", 4474.0, "N/m", bounds=(3000, 7000))
    damping = system.parameter("damping", 38.0, "N s/m", bounds=(5, 200))
    system.parameter("bound", 10.0, bounds=(1, 100), description="of both peaks")
    machine = system.add(planar.Particle("machine", mass=MASS))
    absorber = system.add(planar.Particle("absorber", mass=ADDED, position=(0, 0.4)))
    for name, body in (("guide", machine), ("slide", absorber)):
        system.add(planar.PinInSlot(name, system.ground.center, body.center, axis=(0, 1)))
    ends = system.ground.point(0, -0.4), machine.center
    system.add(planar.Spring("springs", *ends, stiffness=SUPPORT, free_length=0.4))
    ends, numbers = (machine.center, absorber.center), {"stiffness": stiffness, "damping": damping}
    system.add(planar.Spring("tuning", *ends, free_length=0.4, **numbers))
    system.add(planar.Force("force", machine.center, (0, push)))
    system.output("gain", SUPPORT * machine.y)
    return system


def ratios(values) -> tuple[float, float]:
    """Frequency and damping ratio of an absorber."""
    own = math.sqrt(values["stiffness"] / ADDED)
    return own / OMEGA, values["damping"] / (2 * ADDED * own)


def tuned(frequency: float, ratio: float) -> dict[str, float]:
    """Stiffness and damping of an absorber from its ratios."""
    own = frequency * OMEGA
    return {"stiffness": ADDED * own**2, "damping": 2 * ratio * ADDED * own}


def den_hartog(mu: float) -> tuple[float, float]:
    """Ratios by the fixed points of the response, 1956."""
    return 1 / (1 + mu), math.sqrt(3 * mu / (8 * (1 + mu)))


def equal_peaks(mu: float) -> tuple[float, float, float]:
    """Ratios and height of the lowest peak, Nishihara and Asami 2002."""
    q = math.sqrt(4 + 3 * mu)
    inner = 2 * (16 + 23 * mu + 9 * mu**2 + 2 * (2 + mu) * q) / (3 * (64 + 80 * mu + 27 * mu**2))
    height = ((8 + 9 * mu) ** 2 * (16 + 9 * mu) - 128 * q**3) / (3 * (32 + 27 * mu))
    ratio = math.sqrt((8 + 9 * mu - 4 * q) / (1 + mu)) / 4
    return 2 * math.sqrt(inner) / (1 + mu), ratio, math.sqrt(height) / (3 * mu)


def least_noise(mu: float) -> tuple[float, float]:
    """Ratios for white noise, Crandall and Mark 1963, Warburton 1982."""
    ratio = math.sqrt(mu * (1 + 3 * mu / 4) / (4 * (1 + mu) * (1 + mu / 2)))
    return math.sqrt(1 + mu / 2) / (1 + mu), ratio


def main(folder=None) -> dict[str, float]:
    model = build().build()
    sweep = da.FrequencyResponse(span=SPAN)
    bound = da.final("bound")
    peaks = [da.peak(number, "gain.amplitude") - bound for number in (1, 2)]
    lowest = da.optimize(
        model,
        minimize=bound,
        subject_to=[da.Limit(peak, upper=0.0) for peak in peaks],
        vary=["stiffness", "damping", "bound"],
        analysis=sweep,
        method="ipopt",
        tolerance=1e-10,
    )
    noise = da.RandomResponse(psd={"push": 1.0}, span=SPAN)
    quiet = da.optimize(
        model,
        minimize=da.random_rms("gain"),
        vary=["stiffness", "damping"],
        analysis=noise,
        tolerance=1e-14,
    )
    rules = tuned(*den_hartog(SHARE))
    highest = da.maximum("gain.amplitude")
    by_rules = da.evaluate(sweep.run(model, rules), highest)
    exact = equal_peaks(SHARE)
    print(f"highest peak: Den Hartog {by_rules:.6f}, optimum {lowest.x['bound']:.6f}")
    for name, ratio in zip(("frequency", "damping"), ratios(lowest.x), strict=True):
        print(f"{name} ratio of the lowest peak {ratio:.6f}")
    if folder:
        draw(folder, model, sweep, rules, lowest.x, quiet.x)
    return {
        "rules": by_rules,
        "height": lowest.x["bound"],
        "exact height": exact[2],
        "frequency": ratios(lowest.x)[0],
        "exact frequency": exact[0],
        "damping": ratios(lowest.x)[1],
        "exact damping": exact[1],
        "quiet frequency": ratios(quiet.x)[0],
        "quiet damping": ratios(quiet.x)[1],
    }


def draw(folder, model, sweep, rules, lowest, quiet) -> None:
    figure, axes = plt.subplots(figsize=(7, 4))
    frequencies = np.linspace(*SPAN, 800)
    designs = {
        "Den Hartog": rules,
        "lowest peak": {name: lowest[name] for name in rules},
        "white noise": {name: quiet[name] for name in rules},
        "hardly damped": rules | {"damping": 6.0},
    }
    looks = {"Den Hartog": "--", "hardly damped": ":"}
    for name, values in designs.items():
        response = sweep.run(model, values).at(frequencies)
        axes.plot(frequencies, response.values("gain.amplitude"), looks.get(name, "-"), label=name)
    axes.set_ylim(0, 14)
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("displacement over the static one")
    axes.set_title("Machine with an absorber of 5 % of its mass")
    axes.legend()
    style.save(figure, folder, "den_hartog_absorber")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
