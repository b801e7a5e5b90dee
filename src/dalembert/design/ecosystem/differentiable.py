"""Responses as functions that JAX and PyTorch differentiate, each an optional package.

Their automatic differentiation meets ``x → R(x)`` as one operation whose transposed derivative is
the gradient of this package, so that a mechanism may stand among their layers and losses.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import UnsupportedError

if TYPE_CHECKING:
    from dalembert.design.ecosystem.functions import DesignFunctions


def jax_function(functions: DesignFunctions) -> Callable[[Any], Any]:
    """``x → (m,)`` for ``jax.grad``, ``jax.jit`` and ``jax.vmap``, one design after the other.

    Raises
    ------
    UnsupportedError
        JAX is not there.
    """
    try:
        import jax
    except ImportError:
        raise UnsupportedError("jax needs JAX: pip install jax") from None

    def called(host: Callable[..., np.ndarray], size: int, *given: Any) -> Any:
        kind = given[0].dtype

        def on_host(*arrays: Any) -> np.ndarray:
            return host(*(np.asarray(a, dtype=float) for a in arrays)).astype(kind)

        shape = jax.ShapeDtypeStruct((size,), kind)
        return jax.pure_callback(on_host, shape, *given, vmap_method="sequential")

    @jax.custom_vjp
    def values(x: Any) -> Any:
        return called(functions.values, functions.count, x)

    def forward(x: Any) -> tuple[Any, Any]:
        return values(x), x

    def backward(x: Any, weights: Any) -> tuple[Any]:
        return (called(lambda x, w: w @ functions.jacobian(x), len(functions.names), x, weights),)

    values.defvjp(forward, backward)
    return values  # type: ignore[no-any-return]


def torch_function(functions: DesignFunctions) -> Callable[[Any], Any]:
    """``x → (m,)`` for tensors, in the graph of ``backward``.

    Raises
    ------
    UnsupportedError
        PyTorch is not there.
    """
    try:
        import torch
    except ImportError:
        raise UnsupportedError("torch needs PyTorch: pip install torch") from None

    def plain(x: Any) -> np.ndarray:
        found: np.ndarray = x.detach().cpu().double().numpy()
        return found

    class Values(torch.autograd.Function):  # type: ignore[misc, name-defined]
        @staticmethod
        def forward(ctx: Any, x: Any) -> Any:
            ctx.save_for_backward(x)
            return x.new_tensor(functions.values(plain(x)))

        @staticmethod
        def backward(ctx: Any, *weights: Any) -> Any:
            (x,) = ctx.saved_tensors
            return weights[0] @ x.new_tensor(functions.jacobian(plain(x)))

    return Values.apply  # type: ignore[no-any-return]
