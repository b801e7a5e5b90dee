"""Four-bar linkage and speed controller as two functional mock-up units, coupled step by step.

The linkage has a motor torque as input, the controller a measured speed. Each is exported as a
unit; a master of a few lines exchanges their signals every millisecond, as other programs do. The
same loop in one model, in which the signals are exchanged at every stage of a step, is the
reference. The units also give exact adjoint derivatives, shown for the start of the linkage.

This script needs FMPy; the units do not.
"""

import shutil
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import style
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave

import dalembert as da
from dalembert import planar

STEP, DURATION, TARGET = 1e-3, 2.0, 6.0
GAINS = {"proportional": 20.0, "integral": 60.0}


def add_bars(system: da.System) -> planar.Bar:
    """Crank, coupler and rocker; returns the crank."""
    length = system.parameter("length", 0.3, unit="m", description="crank length")
    crank = planar.Bar("crank", length=length, mass=1.5, angle=1.5, angular_velocity=4.0)
    coupler = planar.Bar("coupler", length=1.0, mass=5.0, angle=0.2)
    rocker = planar.Bar("rocker", length=0.6, mass=3.0, angle=1.2)
    for bar in (crank, coupler, rocker):
        system.add(bar)
    system.add(planar.Revolute("O1", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1.0, 0.0), rocker.start))
    return crank


def linkage() -> da.Model:
    """The linkage alone; its input is the torque."""
    system = da.System("linkage", gravity=(0.0, -9.81))
    crank = add_bars(system)
    system.add(planar.Torque("motor", crank, system.input("torque", unit="N m")))
    system.output("speed", crank.angular_velocity, unit="rad/s")
    system.output("acceleration", crank.angular_acceleration, unit="rad/s^2")
    return system.build()


def controller() -> da.Model:
    """The controller alone; its input is the speed."""
    system = da.System("controller")
    speed = system.input("speed", unit="rad/s")
    pid = system.add(da.blocks.PID("pid", TARGET, speed, **GAINS))
    system.output("torque", pid.output, unit="N m")
    return system.build()


def closed_loop() -> da.Model:
    """Linkage and controller in one model."""
    system = da.System("closed loop", gravity=(0.0, -9.81))
    crank = add_bars(system)
    pid = system.add(da.blocks.PID("pid", TARGET, crank.angular_velocity, **GAINS))
    system.add(planar.Torque("motor", crank, pid.output))
    return system.build()


class Unit:
    """An instance of a unit by the names of its variables."""

    def __init__(self, path: Path):
        self.folder = extract(str(path))
        description = read_model_description(str(path))
        self.reference = {v.name: v.valueReference for v in description.modelVariables}
        self.instance = FMU3Slave(
            guid=description.instantiationToken,
            unzipDirectory=self.folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=description.modelName,
        )
        self.instance.instantiate()
        self.instance.enterInitializationMode()

    def get(self, name: str) -> float:
        return self.instance.getFloat64([self.reference[name]])[0]

    def set(self, name: str, value: float) -> None:
        self.instance.setFloat64([self.reference[name]], [value])

    def adjoint(self, output: str, inputs: list[str]) -> list[float]:
        """Derivatives of an output by inputs or parameters, by one adjoint."""
        numbers = [self.reference[name] for name in inputs]
        return self.instance.getAdjointDerivative(
            [self.reference[output]], numbers, [1.0], len(numbers)
        )

    def close(self) -> None:
        self.instance.terminate()
        self.instance.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def coupled(plant: Unit, control: Unit, step: float) -> np.ndarray:
    """Speeds at the ends of the steps; each unit sees the signals of the start of a step."""
    for unit in (plant, control):
        unit.instance.exitInitializationMode()
    speeds = [plant.get("speed")]
    for k in range(round(DURATION / step)):
        control.set("speed", speeds[-1])
        plant.set("torque", control.get("torque"))
        for unit in (plant, control):
            unit.instance.doStep(k * step, step)
        speeds.append(plant.get("speed"))
    return np.array(speeds)


def main(folder=None) -> dict[str, float]:
    reference = da.solve_dynamics(closed_loop(), DURATION, step=STEP)
    expected = reference["crank.angular_velocity"].values
    numbers, speeds = {}, {}
    with tempfile.TemporaryDirectory() as place:
        paths = [Path(place) / f"{name}.fmu" for name in ("linkage", "controller")]
        for model, path in zip((linkage(), controller()), paths, strict=True):
            da.export_fmu(model, path, step=STEP)
        for step in (8 * STEP, 4 * STEP, STEP):
            plant, control = (Unit(path) for path in paths)
            slopes = plant.adjoint("acceleration", ["length", "torque"])
            speeds[step] = coupled(plant, control, step)
            error = np.abs(speeds[step] - expected[:: round(step / STEP)]).max()
            numbers[f"difference, coupled every {step * 1e3:g} ms [rad/s]"] = float(error)
            plant.close()
            control.close()
    numbers["final speed [rad/s]"] = float(speeds[STEP][-1])
    numbers["final speed in one model [rad/s]"] = float(expected[-1])
    numbers["acceleration per length [rad/(m s²)]"] = slopes[0]
    numbers["acceleration per torque [1/(kg m²)]"] = slopes[1]
    print(*(f"{name}: {value:.9g}" for name, value in numbers.items()), sep="\n")
    if folder:
        figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.4))
        style.draw(left, reference, DURATION)
        left.set_title("linkage with a motor")
        right.plot(
            reference.time, expected, color=style.GREY, label="one model", linewidth=4, alpha=0.4
        )
        for step in (8 * STEP, STEP):
            instants = np.arange(len(speeds[step])) * step
            right.plot(instants, speeds[step], label=f"units, coupled every {step * 1e3:g} ms")
        right.axhline(TARGET, color=style.GREY, linestyle=":")
        right.set(
            xlabel="time [s]", ylabel="crank speed [rad/s]", title="speed control by two units"
        )
        right.legend()
        style.save(figure, folder, "fmu_control")
    return numbers


if __name__ == "__main__":
    main(*sys.argv[1:])
