"""All cases, in the order of the table."""

from benchmarks.cases import (
    build,
    cold_start,
    contact_gradients,
    falling_bodies,
    flexible_bar,
    gradients,
    live_pages,
    machine_code,
    memory,
    motions,
    plate,
    soft_pendulum,
)

CASES = [
    *motions.CASES,
    soft_pendulum.CASE,
    flexible_bar.CASE,
    plate.CASE,
    *falling_bodies.CASES,
    contact_gradients.CASE,
    gradients.CASE,
    build.CASE,
    machine_code.CASE,
    cold_start.CASE,
    memory.CASE,
    live_pages.CASE,
]
