"""What stands for a number of CasADi's text in LLVM IR: one double, or one for each lane."""

from __future__ import annotations

import struct
from dataclasses import dataclass

from dalembert.symbolic.native.sines import sines

INTRINSICS = {
    **{name: name for name in ("sin", "cos", "exp", "log", "sqrt", "floor", "ceil", "pow")},
    **{"fabs": "fabs", "casadi_fabs": "fabs", "copysign": "copysign"},
    **{"fmin": "minnum", "casadi_fmin": "minnum", "fmax": "maxnum", "casadi_fmax": "maxnum"},
}
"""C name → what LLVM calls it; these exist for lanes, too."""
LIBRARY = {
    **{name: name for name in ("tan", "asin", "acos", "atan", "sinh", "cosh", "tanh")},
    **{name: name for name in ("asinh", "acosh", "atanh", "erf", "fmod", "remainder", "atan2")},
    **{name: name for name in ("log1p", "expm1", "hypot")},
    **{f"casadi_{name}": name for name in ("log1p", "expm1", "hypot")},
}
"""C name → function of the mathematical library of the system."""


@dataclass(frozen=True)
class Real:
    """The type of a number."""

    lanes: int = 1

    @property
    def ir(self) -> str:
        return "double" if self.lanes == 1 else f"<{self.lanes} x double>"

    @property
    def flag(self) -> str:
        """The type of what a comparison tells."""
        return "i1" if self.lanes == 1 else f"<{self.lanes} x i1>"

    @property
    def all_true(self) -> str:
        return "true" if self.lanes == 1 else f"<{', '.join(['i1 true'] * self.lanes)}>"

    @property
    def suffix(self) -> str:
        """What ends the names of LLVM's functions of this type."""
        return "f64" if self.lanes == 1 else f"v{self.lanes}f64"

    def constant(self, number: str | float) -> str:
        """A number of the text; exactly, thus in hexadecimals."""
        (bits,) = struct.unpack("<Q", struct.pack("<d", float(number)))
        one = f"0x{bits:016X}"
        return one if self.lanes == 1 else f"<{', '.join([f'double {one}'] * self.lanes)}>"

    def call(self, name: str, given: list[str]) -> str | None:
        """The call of a mathematical function; None for one that is not known."""
        if self.lanes > 1 and name in TURNING:
            callee = f"{name}.{self.suffix}"
        elif name in INTRINSICS:
            callee = f"llvm.{INTRINSICS[name]}.{self.suffix}"
        elif name in LIBRARY:
            callee = LIBRARY[name] + ("" if self.lanes == 1 else f".{self.suffix}")
        else:
            return None
        return f"call {self.ir} @{callee}({', '.join(f'{self.ir} {value}' for value in given)})"

    @property
    def both(self) -> str:
        """The type of a sine and a cosine."""
        return f"{{{self.ir}, {self.ir}}}"

    def turned(self, value: str) -> str:
        """The call that gives both of an angle in lanes."""
        return f"call {self.both} @sincos.{self.suffix}({self.ir} {value})"

    def declarations(self, text: str) -> list[str]:
        """Declarations of the mathematical functions that a text calls."""
        made: list[str] = []
        if any(f"@{name}.{self.suffix}(" in text for name in ("sincos", *TURNING)):
            made = sines(self.ir, self.lanes, self.constant)
            text = "\n".join([text, *made])
        for name in sorted(set(INTRINSICS.values())):
            if f"@llvm.{name}.{self.suffix}(" in text:
                made.append(f"declare {self.ir} @llvm.{name}.{self.suffix}({self._given(name)})")
        for name in sorted(set(LIBRARY.values())):
            if f"@{name}(" in text or f"@{name}.{self.suffix}(" in text:
                made.append(f"declare double @{name}({Real()._given(name)})")
            if self.lanes > 1 and f"@{name}.{self.suffix}(" in text:
                made += self._lane_by_lane(name)
        return made

    def _given(self, name: str) -> str:
        return ", ".join([self.ir] * (2 if name in TWO else 1))

    def _lane_by_lane(self, name: str) -> list[str]:
        """A function of lanes that calls one of numbers."""
        count = 2 if name in TWO else 1
        head = ", ".join(f"{self.ir} %x{k}" for k in range(count))
        lines, last = [f"define internal {self.ir} @{name}.{self.suffix}({head}) {{"], "undef"
        for lane in range(self.lanes):
            for k in range(count):
                lines.append(f"  %x{k}.{lane} = extractelement {self.ir} %x{k}, i32 {lane}")
            given = ", ".join(f"double %x{k}.{lane}" for k in range(count))
            lines.append(f"  %y{lane} = call double @{name}({given})")
            lines.append(
                f"  %r{lane} = insertelement {self.ir} {last}, double %y{lane}, i32 {lane}"
            )
            last = f"%r{lane}"
        return [*lines, f"  ret {self.ir} {last}", "}"]


TURNING = ("sin", "cos")
"""Functions that lanes have of their own."""
TWO = frozenset(
    ["pow", "copysign", "minnum", "maxnum", "fmod", "remainder", "atan2", "hypot"],
)
"""Functions of two numbers."""
