"""What the commands write and tell of a mechanism and its results."""

from __future__ import annotations

from typing import Any

from dalembert.cli.console import head, shown, tell
from dalembert.cli.parameters import parameters, print_parameters
from dalembert.cli.teller import Teller
from dalembert.model.model import Model


class MechanismTeller(Teller[Model]):
    """A mechanism and its results."""

    @property
    def description(self) -> dict[str, Any]:
        """The diagnosis with parameters and derived values."""
        return {
            "diagnosis": self.model.diagnosis.to_dict(),
            "parameters": parameters(self.model),
            "derived": self.derived_values,
        }

    @property
    def derived_values(self) -> dict[str, dict[str, Any]]:
        """Values of the derived parameters at the nominal ones."""
        import casadi as ca

        made = self.model.derived_parameters
        if not made:
            return {}
        formulas = ca.vertcat(*(d.sx for d in made.values()))
        function = ca.Function("derived", [self.model.equations.p], [formulas])
        values = function(self.model.nominal).full().ravel()
        return {
            name: {"value": float(value), "unit": d.unit}
            for (name, d), value in zip(made.items(), values, strict=True)
        }

    @property
    def sentence(self) -> str:
        """What it is, in one line."""
        return self.model.diagnosis.summary

    @property
    def messages(self) -> list[tuple[str, str]]:
        """(level, text) of what is doubtful about it."""
        return self.model.diagnosis.messages

    def explain(self) -> None:
        """Print all that is known of it."""
        d = self.model.diagnosis
        head(self.model.name, d.summary)
        count = f"{d.coordinates} coordinates − {d.joint_equations} joint equations = {d.gruebler}"
        redundant = d.gruebler != d.degrees_of_freedom
        note = " (redundant equations make the difference)" if redundant else ""
        tell(f"  Grübler count  {count}{note}")
        for title, names in (
            ("bodies", d.bodies),
            ("joints", d.joints),
            ("drivers", d.drivers),
            ("forces", d.forces),
        ):
            if names:
                tell(f"  {title:<9} {len(names):>4}  {', '.join(names)}")
        for loop in d.topology.loops:
            tell(f"  loop            {' → '.join(loop)}")
        print_parameters(self.model)
        for name, entry in self.derived_values.items():
            tell(f"  derived         {name} = {entry['value']:g} {entry['unit']}")
        for level, text in d.messages:
            tell(f"  {level}: {text}", "yellow" if level == "warning" else None)

    def show(self, made: dict[str, Any]) -> None:
        """Print a summary."""
        pairs = {f"{name} [J]": value for name, value in made.get("final", {}).items()}
        for name, value in (pairs | made.get("largest", {})).items():
            tell(f"  {name.replace('_', ' '):<24} {shown(value)}")
        for event in made.get("events", [])[:20]:
            tell(f"  event {event['name']} at t = {event['time']:.9g} s")
        for number, mode in enumerate(made.get("modes", []), 1):
            listed = ", ".join(f"{name} {value:.6g}" for name, value in mode.items())
            tell(f"  mode {number}: {listed}")
