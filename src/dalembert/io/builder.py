"""Construction of a model from a validated document, in order of dependence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from dalembert.budget import check_budget
from dalembert.errors import ModelError
from dalembert.io.declarations import (
    declare_derived,
    declare_inputs,
    declare_outputs,
    declare_parameters,
    declare_tables,
)
from dalembert.io.documents import Document, StructureDocument
from dalembert.io.finite_element_tables import DISPLACEMENTS, VELOCITIES
from dalembert.io.finite_elements import FiniteElements
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.location import Located
from dalembert.io.mechanism_elements import MechanismElements
from dalembert.io.messages import explain
from dalembert.io.reading import read_document
from dalembert.io.schema import ModelDocument
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.system import System
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.text.wording import visible

NAME = 25
"""Estimated cost per declared name, in the rounds of the budget."""


class Builder:
    """Builder of the system that a document describes.

    Parameters
    ----------
    document : ModelDocument
    source : path of the file, for messages and relative paths
    """

    def __init__(self, document: ModelDocument, source: Path):
        self.document, self.source = document, source
        self.located = Located(source, document)
        name = document.name or visible(source.stem)
        self.system: System = document.builder(name, description=document.description)
        self.formulas = Formulas(self.system)
        self.elastic = FiniteElements(document, self.system, self.located, self.formulas)
        self.structures: dict[Path, StructuralModel] = {}

    def build(self) -> System:
        """The system.

        Raises
        ------
        ModelError, FileError, UnsupportedError
            Names file, location, value and a fix.
        """
        if isinstance(self.document, Document):
            self._check_budget(self.document)
        declare_parameters(self.system, self.document, self.located)
        declare_tables(self.system, self.document, self.located, self.formulas)
        declare_derived(self.system, self.document, self.located, self.formulas)
        declare_inputs(self.system, self.document, self.located, self.formulas)
        declare_outputs(self.system, self.document, self.located)
        if isinstance(self.document, Document):
            self.mechanism(self.document)
        else:
            self.elastic.add()
        self.elastic.add_conditions()
        self.initial()
        return self.system

    def mechanism(self, document: Document) -> None:
        """Add bodies, finite elements, joints, drivers and forces."""
        parts = (document, self.system, self.located, self.formulas, self.structure)
        elements = MechanismElements(*parts)
        elements.histories()
        elements.ground()
        elements.section("bodies")
        elements.section("beams")
        self.elastic.add()
        elements.blocks()
        elements.section("joints")
        elements.section("drivers")
        elements.forces_and_inputs()

    def initial(self) -> None:
        """Prescribe measures, or motions of nodes, at the start."""
        if isinstance(self.document.initial, list):
            return
        for measure, value in self.document.initial.items():
            with self.located("initial", measure):
                number = self.formulas.read(value)
                owner, _, direction = measure.rpartition(".")
                if owner in self.document.nodes and direction in DISPLACEMENTS | VELOCITIES:
                    self.system.initial(self.system.nodes[owner], **{direction: number})
                else:
                    quantity = self.formulas.read(measure, Scope.MOTION)
                    self.system.initial(as_expression(quantity, ""), number)

    def _check_budget(self, document: Document) -> None:
        """Refuse more names than can be processed in reasonable time."""
        owners = [document.ground, *document.bodies.values()]
        tables = [owner if isinstance(owner, dict) else vars(owner) for owner in owners]
        points = (table.get(key) for table in tables for key in ("points", "frames"))
        counts = {
            "parameters": len(document.parameters),
            "derived parameters": len(document.derived),
            "inputs": len(document.inputs),
            "outputs": len(document.outputs),
            "bodies": len(document.bodies),
            "points and frames": sum(len(named or ()) for named in points),
            "joints": len(document.joints),
            "forces": len(document.forces),
            "blocks": len(document.blocks),
        }
        for section, count in counts.items():
            check_budget(
                f"{self.source}: {count} {section}", rounds=NAME * count, cure="give fewer"
            )

    def structure(self, path: Path) -> StructuralModel:
        """The structure in another file; each file is read once."""
        if path not in self.structures:
            data = read_document(path)
            if data.get("kind") != "structure":
                raise ModelError(
                    f'{path.name} is no structure; give a file with kind = "structure"'
                )
            try:
                document = StructureDocument.model_validate(data)
            except ValidationError as error:
                raise explain(error, data, path) from None
            model: Any = Builder(document, path).build().build()
            self.structures[path] = model
        return self.structures[path]
