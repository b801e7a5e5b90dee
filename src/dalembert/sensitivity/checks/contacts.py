"""What gradients do not tell by themselves of runs with rigid contacts."""

from __future__ import annotations

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.dynamics_kernel import DynamicsKernel
from dalembert.results.recording import Recording
from dalembert.results.result import Result


def through_contacts(motion: Result) -> list[str]:
    """Sentences about impacts whose order or number changes with the parameters."""
    kernel = getattr(getattr(motion, "record", None), "kernel", None)
    if not isinstance(motion, Recording) or not isinstance(kernel, DynamicsKernel):
        return []
    names = [gap.name for gap in kernel.equations.contacts]
    notes = []
    for k, change in kernel.crossings(motion.record.steps):
        if not isinstance(change, ContactChange):
            continue
        time = motion.record.steps.t[k]
        for gap in sorted(change.closes):
            notes.append(
                f"bounces of {names[gap]} accumulate at t = {time:.6g} s and end there: the "
                "derivative is that of the bounces taken, whose number changes with parameters"
            )
        if change.together:
            together = ", ".join(names[gap] for gap in change.together)
            notes.append(
                f"{together} close at one time, t = {time:.6g} s: parameters that part them make "
                "one impact follow the other, so the derivative is that of one impact at once"
            )
    return notes
