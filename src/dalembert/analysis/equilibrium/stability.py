"""Texts about an equilibrium and its stability, for mechanisms and structures."""

from __future__ import annotations

from dalembert.text.wording import counted


def equilibrium_text(
    residual: float, iterations: int, stable: bool, conservative: bool = True
) -> str:
    """Message of the status of an equilibrium; the residual is a force [N]."""
    kind = "stable" if stable else "not a stable position"
    if stable and not conservative:
        kind = "statically stable (loads without potential: check flutter by linearize)"
    return f"residual {residual:.3g} N after {counted(iterations, 'iteration')}, {kind}"


def instability_warnings(negative: int, consequence: str, where: str = "") -> list[str]:
    """Warning about an equilibrium whose tangent stiffness has negative eigenvalues, if any.

    Parameters
    ----------
    negative : number of negative eigenvalues
    consequence : physical meaning, and remedy
    where : load case
    """
    if not negative:
        return []
    place = f"{where}: " if where else ""
    eigenvalues = counted(negative, "negative eigenvalue")
    return [
        f"{place}the equilibrium is not stable: its stiffness has {eigenvalues}, so that "
        f"{consequence}"
    ]
