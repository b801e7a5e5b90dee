"""Responses as differentiable functions of JAX and PyTorch, both optional packages.

Their automatic differentiation treats ``x → R(x)`` as one operation whose vector-Jacobian product
is computed here, so that a mechanism can be combined with their layers and losses.
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
        JAX is not installed.
    """
    try:
        import jax
    except ImportError:
        raise UnsupportedError("jax needs JAX: pip install jax") from None

    def call_on_host(host: Callable[..., np.ndarray], size: int, *arguments: Any) -> Any:
        dtype = arguments[0].dtype

        def evaluate(*arrays: Any) -> np.ndarray:
            return host(*(np.asarray(a, dtype=float) for a in arrays)).astype(dtype)

        shape = jax.ShapeDtypeStruct((size,), dtype)
        return jax.pure_callback(evaluate, shape, *arguments, vmap_method="sequential")

    @jax.custom_vjp
    def responses(x: Any) -> Any:
        return call_on_host(values, count, x)

    def forward(x: Any) -> tuple[Any, Any]:
        return responses(x), x

    def backward(x: Any, weights: Any) -> tuple[Any]:
        return (call_on_host(lambda x, w: w @ jacobian(x), x.size, x, weights),)

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
        PyTorch is not installed.
    """
    try:
        import torch
    except ImportError:
        raise UnsupportedError("torch needs PyTorch: pip install torch") from None

    def to_numpy(x: Any) -> np.ndarray:
        array: np.ndarray = x.detach().cpu().double().numpy()
        return array

    class Values(torch.autograd.Function):  # type: ignore[misc, name-defined]
        @staticmethod
        def forward(ctx: Any, x: Any) -> Any:
            ctx.save_for_backward(x)
            return x.new_tensor(values(to_numpy(x)))

        @staticmethod
        def backward(ctx: Any, *weights: Any) -> Any:
            (x,) = ctx.saved_tensors
            return weights[0] @ x.new_tensor(jacobian(to_numpy(x)))

    return Values.apply  # type: ignore[no-any-return]
