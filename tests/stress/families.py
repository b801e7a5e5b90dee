"""Families of cases by name."""

from __future__ import annotations

from importlib import import_module

from stress.verdict import Judge

FAMILIES = {
    "planar": "random planar mechanisms, judged by their NumPy twin and by a second formulation",
    "spatial": "random spatial trees and loops, judged by a NumPy/SciPy twin",
    "flexible": "beams, flexible bodies and structures, judged by twins and closed forms",
    "contact": "rigid and compliant contacts, judged by their laws and a SciPy twin",
    "numbers": "extreme numbers at every option, in files and in Python",
    "files": "hostile and damaged models, decks, tables and results",
}


def judge(family: str) -> Judge:
    """The judge of a family; its module is imported when it is first needed."""
    return import_module(f"stress.{family}_cases").judge
