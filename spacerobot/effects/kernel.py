"""A kernel: one scalar force law, of one signature, that every backend can call and the compiled one can list."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from types import FunctionType
from typing import Any

import numpy as np

from spacerobot.support import jit

ScalarLaw = Callable[[float, float, float, Any], float]
"""(d, v, aux, p) -> value: displacement [m or rad], rate, an auxiliary rate or input, parameters shape (P,)."""

PARAMETERS = 48
"""Every kernel's parameter vector is padded to this length; a learned curve takes nearly all of it."""


def no_edge(d: float, v: float, aux: float, p: Any) -> float:
    """Edge of a law without kinks: never crossed."""
    return 1.0


def no_energy(d: float, v: float, aux: float, p: Any) -> float:
    """Stored energy of a law that stores none."""
    return 0.0


def no_slope(d: float, v: float, aux: float, p: Any) -> float:
    """Slope of a force that is constant."""
    return 0.0


@dataclass(frozen=True)
class Kernel:
    """A scalar force law in plain Python that Numba can compile.

    The callables share the signature `(d, v, aux, p)`. They are written with `math` and plain arithmetic only.

    Attributes:
        force: force along the positive direction of the port [N or N m]; a restoring law returns -k d.
        edge: a function that changes sign where the law has a kink; the integrators stop there.
        energy: stored energy [J], whose negative gradient in d is the conservative part of `force`.
        slope: for a law of d alone that is continuous, and straight between its edges, -df/dd [N/m or N m/rad];
            its `aux` is the sign of `edge` on the side that is meant. `edge` then is of d alone too, and changes sign
            at most once above d = 0 and once below. Such laws are integrated much faster.
    """

    force: ScalarLaw
    edge: ScalarLaw = no_edge
    energy: ScalarLaw = no_energy
    slope: ScalarLaw | None = None

    @property
    def has_edge(self) -> bool:
        """Whether the law has a kink to stop at."""
        return self.edge is not no_edge


def padded(parameters: tuple[float, ...]) -> np.ndarray:
    """Parameters as the fixed-length vector that kernels read, shape (PARAMETERS,)."""
    if len(parameters) > PARAMETERS:
        raise ValueError(f"a kernel takes at most {PARAMETERS} parameters, got {len(parameters)}")
    vector = np.zeros(PARAMETERS)
    vector[: len(parameters)] = parameters
    return vector


@functools.cache
def compiled(law: ScalarLaw) -> Any:
    """`law` compiled once as a C function of (d, v, aux, pointer to p)."""
    return c_function(law, 3)


def c_function(law: Callable[..., float], numbers: int) -> Any:
    """`law` as a C function of so many numbers and a pointer to p; cached on disk where its source is a file.

    A law may call plain functions of its own package. Division by zero gives an infinity or NaN there, which
    integrators refuse; a C function cannot raise.
    """
    numba = jit.numba()
    _make_callable(law)
    signature = numba.float64(*[numba.float64] * numbers, numba.types.CPointer(numba.float64))
    try:
        with jit.kept_with_laws():
            return numba.cfunc(signature, cache=True, error_model="numpy")(law)
    except RuntimeError:  # no file to cache beside: defined in a notebook or by exec
        return numba.cfunc(signature, error_model="numpy")(law)


@functools.cache
def _make_callable(law: Callable[..., float]) -> None:
    """Let compiled code call what `law` calls: plain functions of the package that it stands in."""
    if not isinstance(law, FunctionType):
        return
    for name in law.__code__.co_names:
        called = law.__globals__.get(name)
        if isinstance(called, FunctionType) and _package(called) == _package(law):
            _make_callable(called)
            jit.numba().extending.register_jitable(called)


def _package(function: FunctionType) -> str:
    return function.__module__.partition(".")[0]
