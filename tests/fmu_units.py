"""Units of models and their instances, for tests."""

from __future__ import annotations

import tempfile
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave

CLASSES = {
    (3, "ModelExchange"): FMU3Model,
    (3, "CoSimulation"): FMU3Slave,
    (2, "ModelExchange"): FMU2Model,
    (2, "CoSimulation"): FMU2Slave,
}


class Instance:
    """An instance of a unit by names of variables; its messages are in ``messages``."""

    def __init__(self, path: Path, kind: str, folder: str | None = None):
        self.folder = folder or fmpy.extract(str(path), tempfile.mkdtemp())
        self.description = md = fmpy.read_model_description(str(path))
        self.version = int(md.fmiVersion[0])
        self.references = {v.name: v.valueReference for v in md.modelVariables}
        self.exchange = kind == "ModelExchange"
        part = md.modelExchange if self.exchange else md.coSimulation
        self.messages: list[str] = []
        self.unit = CLASSES[self.version, kind](
            guid=md.guid if self.version == 2 else md.instantiationToken,
            unzipDirectory=self.folder,
            modelIdentifier=part.modelIdentifier,
            instanceName="test",
        )
        self._instantiate()

    def _instantiate(self) -> None:
        if self.version == 3:
            self.unit.instantiate(logMessage=lambda e, s, c, m: self.messages.append(m.decode()))
            return
        from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

        def log(environment, name, status, category, message):
            self.messages.append(message.decode())

        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(log)
        self._callbacks = callbacks
        self.unit.instantiate(callbacks=callbacks)

    def begin(self, time: float = 0.0, **start: float) -> Instance:
        """Initialise with start values."""
        if self.version == 2:
            self.unit.setupExperiment(startTime=time)
            self.unit.enterInitializationMode()
        else:
            self.unit.enterInitializationMode(startTime=time)
        self.set(**start)
        self.unit.exitInitializationMode()
        if self.exchange:
            self.settle()
            self.unit.enterContinuousTimeMode()
        return self

    def settle(self) -> None:
        """Update discrete states until none changes."""
        update = (
            self.unit.updateDiscreteStates if self.version == 3 else self.unit.newDiscreteStates
        )
        while update()[0]:
            pass

    def set(self, **values: float) -> None:
        numbers = [self.references[name] for name in values]
        method = self.unit.setFloat64 if self.version == 3 else self.unit.setReal
        if numbers:
            method(numbers, list(values.values()))

    def get(self, *names: str) -> np.ndarray:
        numbers = [self.references[name] for name in names]
        method = self.unit.getFloat64 if self.version == 3 else self.unit.getReal
        return np.array(method(numbers))

    def directional(self, unknowns, knowns, seed) -> np.ndarray:
        numbers = [[self.references[n] for n in names] for names in (unknowns, knowns)]
        return np.array(self.unit.getDirectionalDerivative(*numbers, list(seed)))

    def adjoint(self, unknowns, knowns, seed) -> np.ndarray:
        numbers = [[self.references[n] for n in names] for names in (unknowns, knowns)]
        return np.array(self.unit.getAdjointDerivative(*numbers, list(seed), len(knowns)))

    def states(self) -> np.ndarray:
        values = (np.ctypeslib.ctypes.c_double * self.description.numberOfContinuousStates)()
        self.unit.getContinuousStates(values, len(values))
        return np.array(values)

    def set_states(self, x: np.ndarray) -> None:
        values = (np.ctypeslib.ctypes.c_double * len(x))(*x)
        self.unit.setContinuousStates(values, len(values))

    def rates(self) -> np.ndarray:
        values = (np.ctypeslib.ctypes.c_double * self.description.numberOfContinuousStates)()
        if self.version == 3:
            self.unit.getContinuousStateDerivatives(values, len(values))
        else:
            self.unit.getDerivatives(values, len(values))
        return np.array(values)

    def step(self, time: float, length: float) -> None:
        self.unit.doStep(currentCommunicationPoint=time, communicationStepSize=length)

    def free(self) -> None:
        self.unit.terminate()
        self.unit.freeInstance()
