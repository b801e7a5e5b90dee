"""Sine and cosine in lanes, as LLVM IR without a call per lane.

The argument is reduced by ``π/2`` in several parts, keeping the rounding error of the difference,
and the polynomials of fdlibm (Sun Microsystems, 1993) are evaluated: within one unit in the last
place of the exact value. Arguments beyond ``FAR`` and numbers that are not finite are passed to the
mathematical library, so that lanes do not affect each other.
"""

from __future__ import annotations

from collections.abc import Callable

FAR = 1e6
"""Upper limit of arguments for which products with the parts of ``π/2`` are exact."""
ROUNDING = 6755399441055744.0
"""``1.5 · 2⁵²``: adding it rounds to an integer, which is in the lowest bits of the sum."""
TURNS = 6.36619772367581382433e-01
"""``2/π``."""
QUARTER = (1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
"""``π/2`` in parts: two of 33 bits, and the rest."""
SINE = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
COSINE = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)
NAMES = ("sin", "cos")


def sines(ir: str, lanes: int, constant: Callable[[float], str]) -> list[str]:
    """Definitions of ``sincos``, ``sin`` and ``cos`` for the vector type ``ir``."""
    suffix, pair, body = f"v{lanes}f64", f"{{{ir}, {ir}}}", _Body(ir, lanes, constant)
    near = body.rotated(*body.reduced("%x"))
    ends = body.unless_far(near)
    first = body.new(f"insertvalue {pair} undef, {ir} {ends[0]}, 0")
    last = body.new(f"insertvalue {pair} {first}, {ir} {ends[1]}, 1")
    head = f"define internal {pair} @sincos.{suffix}({ir} %x) noinline nounwind {{"
    definitions = [f"declare i1 @llvm.vector.reduce.or.v{lanes}i1(<{lanes} x i1>)"]
    definitions += [f"declare double @{name}(double)" for name in NAMES]
    definitions += [head, *body.lines, f"  ret {pair} {last}", "}"]
    for k, name in enumerate(NAMES):
        definitions += [
            f"define internal {ir} @{name}.{suffix}({ir} %x) nounwind {{",
            f"  %b = call {pair} @sincos.{suffix}({ir} %x)",
            f"  %r = extractvalue {pair} %b, {k}",
            f"  ret {ir} %r",
            "}",
        ]
    return definitions


class _Body:
    """Writer of instructions on vectors."""

    def __init__(self, ir: str, lanes: int, constant: Callable[[float], str]):
        self.ir, self.lanes, self.constant = ir, lanes, constant
        self.flags, self.whole = f"<{lanes} x i1>", f"<{lanes} x i64>"
        self.lines: list[str] = []

    def new(self, right: str) -> str:
        name = f"%v{len(self.lines)}"
        self.lines.append(f"  {name} = {right}")
        return name

    def _binary(self, operation: str, a: str | float, b: str | float) -> str:
        left, right = (x if isinstance(x, str) else self.constant(x) for x in (a, b))
        return self.new(f"{operation} {self.ir} {left}, {right}")

    def add(self, a: str | float, b: str | float) -> str:
        return self._binary("fadd", a, b)

    def less(self, a: str | float, b: str | float) -> str:
        return self._binary("fsub", a, b)

    def times(self, a: str | float, b: str | float) -> str:
        return self._binary("fmul", a, b)

    def polynomial(self, z: str, coefficients: tuple[float, ...]) -> str | float:
        value: str | float = coefficients[-1]
        for c in reversed(coefficients[:-1]):
            value = self.add(c, self.times(z, value))
        return value

    def reduced(self, x: str) -> tuple[str, str, str]:
        """``x`` minus quarter turns, in two parts, and their number in the low bits."""
        first, second, rest = QUARTER
        rounded = self.add(self.times(x, TURNS), ROUNDING)
        count = self.less(rounded, ROUNDING)
        near, more = self.less(x, self.times(count, first)), self.times(count, second)
        nearer = self.less(near, more)
        left = self.less(self.times(count, rest), self.less(self.less(near, nearer), more))
        high = self.less(nearer, left)
        return high, self.less(self.less(nearer, high), left), rounded

    def sine(self, x: str, y: str, z: str) -> str:
        """Sine of ``x + y``, with ``z = x²``."""
        v = self.times(z, x)
        inner = self.less(self.times(0.5, y), self.times(v, self.polynomial(z, SINE[1:])))
        rest = self.less(self.times(z, inner), y)
        return self.less(x, self.less(rest, self.times(v, SINE[0])))

    def cosine(self, x: str, y: str, z: str) -> str:
        """Cosine of ``x + y``, with ``z = x²``."""
        r, half = self.times(z, self.polynomial(z, COSINE)), self.times(0.5, z)
        w = self.less(1.0, half)
        rest = self.less(self.times(z, r), self.times(x, y))
        return self.add(w, self.add(self.less(self.less(1.0, w), half), rest))

    def rotated(self, x: str, y: str, rounded: str) -> list[str]:
        """Sine and cosine of ``x + y`` plus the quarter turns."""
        z, whole = self.times(x, x), self.whole
        values = self.sine(x, y, z), self.cosine(x, y, z)
        one, two, shift = (f"<{', '.join([f'i64 {k}'] * self.lanes)}>" for k in (1, 2, 62))
        count = self.new(f"bitcast {self.ir} {rounded} to {whole}")
        lowest = self.new(f"and {whole} {count}, {one}")
        odd = self.new(f"icmp ne {whole} {lowest}, zeroinitializer")
        results = []
        for k, (straight, crossed) in enumerate((values, values[::-1])):
            size = self.new(f"select {self.flags} {odd}, {self.ir} {crossed}, {self.ir} {straight}")
            turns = self.new(f"add {whole} {count}, {one}") if k else count
            half = self.new(f"and {whole} {turns}, {two}")
            sign, bits = self.new(f"shl {whole} {half}, {shift}"), self._cast(size)
            results.append(
                self.new(f"bitcast {whole} {self.new(f'xor {whole} {bits}, {sign}')} to {self.ir}")
            )
        return results

    def unless_far(self, near: list[str]) -> list[str]:
        """The values ``near``, replaced by the library's in lanes with a far argument."""
        size = self.new(f"call {self.ir} @llvm.fabs.v{self.lanes}f64({self.ir} %x)")
        far = self.new(f"fcmp ugt {self.ir} {size}, {self.constant(FAR)}")
        reduced = f"@llvm.vector.reduce.or.v{self.lanes}i1"
        some = self.new(f"call i1 {reduced}({self.flags} {far})")
        self.lines += [f"  br i1 {some}, label %far, label %end", "far:"]
        called = []
        for name, last in zip(NAMES, near, strict=True):
            value_in_lanes = last
            for lane in range(self.lanes):
                angle = self.new(f"extractelement {self.ir} %x, i32 {lane}")
                value = self.new(f"call double @{name}(double {angle})")
                value_in_lanes = self.new(
                    f"insertelement {self.ir} {value_in_lanes}, double {value}, i32 {lane}"
                )
            chosen = f"{self.flags} {far}, {self.ir} {value_in_lanes}, {self.ir} {last}"
            called.append(self.new(f"select {chosen}"))
        self.lines += ["  br label %end", "end:"]
        pairs = zip(near, called, strict=True)
        return [self.new(f"phi {self.ir} [{a}, %0], [{b}, %far]") for a, b in pairs]

    def _cast(self, number: str) -> str:
        return self.new(f"bitcast {self.ir} {number} to {self.whole}")
