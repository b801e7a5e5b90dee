"""Responses as functions that JAX and PyTorch differentiate, each an optional package.

Their automatic differentiation meets ``x → R(x)`` as one operation whose transposed derivative is
the gradient of this package, so that a mechanism may stand among their layers and losses.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.errors import UnsupportedError

Numbers = Callable[[np.ndarray], np.ndarray]


def jax_function(values: Numbers, jacobian: Numbers, count: int) -> Callable[[Any], Any]:
    """``x → (m,)`` for ``jax.grad``, ``jax.jit`` and ``jax.vmap``, one design after the other.

    Parameters
    ----------
    values, jacobian : (n,) → (m,) and (m, n)
    count : m

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
    def responses(x: Any) -> Any:
        return called(values, count, x)

    def forward(x: Any) -> tuple[Any, Any]:
        return responses(x), x

    def backward(x: Any, weights: Any) -> tuple[Any]:
        return (called(lambda x, w: w @ jacobian(x), x.size, x, weights),)

    responses.defvjp(forward, backward)
    return responses  # type: ignore[no-any-return]


def torch_function(values: Numbers, jacobian: Numbers) -> Callable[[Any], Any]:
    """``x → (m,)`` for tensors, in the graph of ``backward``.

    Parameters
    ----------
    values, jacobian : (n,) → (m,) and (m, n)

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
            return x.new_tensor(values(plain(x)))

        @staticmethod
        def backward(ctx: Any, *weights: Any) -> Any:
            (x,) = ctx.saved_tensors
            return weights[0] @ x.new_tensor(jacobian(plain(x)))

    return Values.apply  # type: ignore[no-any-return]
