"""Coefficients of the force of an MJCF actuator."""

from __future__ import annotations

from dataclasses import dataclass, field

from dalembert.io.imports.xml.element import XmlElement

USED = {"none": 0, "fixed": 1, "affine": 3}
"""Type of a gain or bias → number of its coefficients that count."""
TYPES = tuple(USED)


@dataclass
class Law:
    """Gain and bias of the force ``(g₀ + g₁ L + g₂ L̇) u + b₀ + b₁ L + b₂ L̇``.

    Attributes
    ----------
    gain, bias : (3,) coefficients
    gain_type, bias_type : ``"none"``, ``"fixed"`` or ``"affine"``, which select the ones that count
    kind : tag of the last element; only the same kind and ``"general"`` inherit from it
    """

    gain: list[float] = field(default_factory=lambda: [1.0, 0.0, 0.0])
    bias: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    gain_type: str = "fixed"
    bias_type: str = "none"
    kind: str = "general"

    @property
    def has_damping_ratio(self) -> bool:
        """Whether it is a position servo whose damping is positive, which states a ratio."""
        types = self.gain_type, self.bias_type
        is_servo = types == ("fixed", "affine") and self.gain[0] == -self.bias[1]
        return is_servo and self.bias[2] > 0

    @property
    def coefficients(self) -> tuple[list[float], list[float]]:
        """``g`` and ``b``, zero where they do not count."""
        return _counting(self.gain, self.gain_type), _counting(self.bias, self.bias_type)

    def change(self, element: XmlElement) -> None:
        """Apply what one element gives itself, without its defaults."""
        own = element.attributes
        if "general" not in (self.kind, element.tag) and self.kind != element.tag:
            self.gain, self.bias = [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]
            self.gain_type, self.bias_type = "fixed", "none"
        self.kind = element.tag
        if element.tag == "general":
            for name, values in (("gain", self.gain), ("bias", self.bias)):
                if f"{name}prm" in own:
                    numbers = element.numbers(f"{name}prm")[:3]
                    values[: len(numbers)] = numbers
            if "gaintype" in own:
                self.gain_type = element.choice("gaintype", TYPES)
            if "biastype" in own:
                self.bias_type = element.choice("biastype", TYPES)
        elif element.tag == "motor":
            self.gain[0], self.gain_type, self.bias_type = 1.0, "fixed", "none"
        elif element.tag == "position":
            stiffness = _own(element, "kp", self.gain[0])
            self.gain[0], self.bias[:2] = stiffness, [0.0, -stiffness]
            self.bias[2] = -_own(element, "kv", -self.bias[2])
            self.bias[2] = _own(element, "dampratio", self.bias[2])
            self.gain_type, self.bias_type = "fixed", "affine"
        elif element.tag == "velocity":
            damping = _own(element, "kv", self.gain[0])
            self.gain[0], self.bias = damping, [0.0, 0.0, -damping]
            self.gain_type, self.bias_type = "fixed", "affine"
        elif element.tag == "damper":
            inherited = -self.gain[2] if self.gain_type == "affine" else 0.0
            self.gain = [0.0, 0.0, -_own(element, "kv", inherited)]
            self.gain_type, self.bias_type = "affine", "none"


def _own(element: XmlElement, name: str, default: float) -> float:
    return element.number(name) if name in element.attributes else default


def _counting(values: list[float], kind: str) -> list[float]:
    count = USED[kind]
    return values[:count] + [0.0] * (3 - count)
