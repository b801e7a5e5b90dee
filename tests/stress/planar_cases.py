"""Planar mechanisms: the NumPy twin judges any strategy; two precise runs and the default agree."""

from __future__ import annotations

import numpy as np
from random_mechanisms import Mechanism, random_mechanism
from random_strategies import judged_mechanism

import dalembert as da
from stress.agreement import PRECISE, USUAL, difference, precise_motion

DURATION = 0.15
OUTCOMES = {outcome.name for outcome in da.Outcome}


def judge(seed: int) -> tuple[str, str, str]:
    """Twin first, then agreement."""
    return judge_mechanism(seed, *random_mechanism(seed))


def judge_mechanism(seed: int, kind: str, m: Mechanism) -> tuple[str, str, str]:
    computed = judged_mechanism(seed, kind, m)
    case = f"{kind} {computed.choices}"
    if computed.faults:
        return "false success", case, "; ".join(computed.faults)
    if computed.verdict != "completed":
        kind = "ended" if computed.verdict in OUTCOMES else "refused"
        return (kind, case, computed.message) if computed.message else ("crash", case, "no reason")
    return agreeing(m.system.build(), kind, np.random.default_rng([seed, 3]))


def agreeing(model: da.Model, kind: str, rng: np.random.Generator) -> tuple[str, str, str]:
    """Two precise runs by random strategies and the default run end alike, or say why not."""
    case = kind
    try:
        (first, a), (second, b) = (precise_motion(model, DURATION, rng) for _ in range(2))
        case = f"{kind} {a} {b}"
        default = da.solve_dynamics(model, DURATION)
    except da.DalembertError as error:
        return "refused", case, str(error)
    sound = [run for run in (first, second, default) if run.status.success]
    if not sound or default not in sound or first not in sound:
        ends = [run.status for run in (first, second, default) if not run.status.success]
        return "ended", case, str(ends[0])
    if second in sound and (far := difference(first, second)) > PRECISE:
        return "false success", case, f"precise runs differ by {far:.2g}"
    if (far := difference(first, default)) > USUAL and not default.warnings:
        return "false success", case, f"the default run differs by {far:.2g} without a warning"
    return "completed", case, ""
