"""Real numbers in LLVM IR: a double, or a vector of doubles with one entry per lane."""

from __future__ import annotations

import struct
from dataclasses import dataclass

from dalembert.symbolic.native.sines import sines

INTRINSICS = {
    **{name: name for name in ("sin", "cos", "exp", "log", "sqrt", "floor", "ceil", "pow")},
    **{"fabs": "fabs", "casadi_fabs": "fabs", "copysign": "copysign"},
    **{"fmin": "minnum", "casadi_fmin": "minnum", "fmax": "maxnum", "casadi_fmax": "maxnum"},
}
"""C name → name of LLVM's intrinsic, which exists for lanes, too."""
LIBRARY = {
    **{name: name for name in ("tan", "asin", "acos", "atan", "sinh", "cosh", "tanh")},
    **{name: name for name in ("asinh", "acosh", "atanh", "erf", "fmod", "remainder", "atan2")},
    **{name: name for name in ("log1p", "expm1", "hypot")},
    **{f"casadi_{name}": name for name in ("log1p", "expm1", "hypot")},
}
"""C name → function of the system's mathematical library."""


@dataclass(frozen=True)
class Real:
    """Type of real numbers."""

    lanes: int = 1

    @property
    def ir(self) -> str:
        return "double" if self.lanes == 1 else f"<{self.lanes} x double>"

    @property
    def flag(self) -> str:
        """Type of the result of a comparison."""
        return "i1" if self.lanes == 1 else f"<{self.lanes} x i1>"

    @property
    def all_true(self) -> str:
        return "true" if self.lanes == 1 else f"<{', '.join(['i1 true'] * self.lanes)}>"

    @property
    def suffix(self) -> str:
        """Suffix of the names of LLVM's functions of this type."""
        return "f64" if self.lanes == 1 else f"v{self.lanes}f64"

    def constant(self, number: str | float) -> str:
        """A constant, written exactly in hexadecimal."""
        (bits,) = struct.unpack("<Q", struct.pack("<d", float(number)))
        text = f"0x{bits:016X}"
        return text if self.lanes == 1 else f"<{', '.join([f'double {text}'] * self.lanes)}>"

    def call(self, name: str, arguments: list[str]) -> str | None:
        """The call of a mathematical function; None for an unknown one."""
        if self.lanes > 1 and name in SINE_COSINE:
            callee = f"{name}.{self.suffix}"
        elif name in INTRINSICS:
            callee = f"llvm.{INTRINSICS[name]}.{self.suffix}"
        elif name in LIBRARY:
            callee = LIBRARY[name] + ("" if self.lanes == 1 else f".{self.suffix}")
        else:
            return None
        values = ", ".join(f"{self.ir} {value}" for value in arguments)
        return f"call {self.ir} @{callee}({values})"

    @property
    def pair(self) -> str:
        """Type of a pair of sine and cosine."""
        return f"{{{self.ir}, {self.ir}}}"

    def sincos(self, value: str) -> str:
        """The call that returns sine and cosine of an angle in lanes."""
        return f"call {self.pair} @sincos.{self.suffix}({self.ir} {value})"

    def declarations(self, text: str) -> list[str]:
        """Declarations of the mathematical functions called by a text."""
        lines: list[str] = []
        if any(f"@{name}.{self.suffix}(" in text for name in ("sincos", *SINE_COSINE)):
            lines = sines(self.ir, self.lanes, self.constant)
            text = "\n".join([text, *lines])
        for name in sorted(set(INTRINSICS.values())):
            if f"@llvm.{name}.{self.suffix}(" in text:
                types = self._argument_types(name)
                lines.append(f"declare {self.ir} @llvm.{name}.{self.suffix}({types})")
        for name in sorted(set(LIBRARY.values())):
            if f"@{name}(" in text or f"@{name}.{self.suffix}(" in text:
                lines.append(f"declare double @{name}({Real()._argument_types(name)})")
            if self.lanes > 1 and f"@{name}.{self.suffix}(" in text:
                lines += self._lane_by_lane(name)
        return lines

    def _argument_types(self, name: str) -> str:
        return ", ".join([self.ir] * (2 if name in BINARY_FUNCTIONS else 1))

    def _lane_by_lane(self, name: str) -> list[str]:
        """Definition of a function in lanes that calls the scalar function for each lane."""
        count = 2 if name in BINARY_FUNCTIONS else 1
        head = ", ".join(f"{self.ir} %x{k}" for k in range(count))
        lines, last = [f"define internal {self.ir} @{name}.{self.suffix}({head}) {{"], "undef"
        for lane in range(self.lanes):
            for k in range(count):
                lines.append(f"  %x{k}.{lane} = extractelement {self.ir} %x{k}, i32 {lane}")
            arguments = ", ".join(f"double %x{k}.{lane}" for k in range(count))
            lines.append(f"  %y{lane} = call double @{name}({arguments})")
            lines.append(
                f"  %r{lane} = insertelement {self.ir} {last}, double %y{lane}, i32 {lane}"
            )
            last = f"%r{lane}"
        return [*lines, f"  ret {self.ir} {last}", "}"]


SINE_COSINE = ("sin", "cos")
"""Functions with their own implementation in lanes."""
BINARY_FUNCTIONS = frozenset(
    ["pow", "copysign", "minnum", "maxnum", "fmod", "remainder", "atan2", "hypot"],
)
"""Functions of two arguments."""
