"""Compiling what reads the integrator's record, in a process that has nothing else to do meanwhile.

The first run after an installation waits for the compiler. Compiled functions are kept on disk as they are finished, so
that another process may take a part of them off this one's hands.
"""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np

from spacerobot.simulation.reduced.law_table import LAWS
from spacerobot.simulation.reduced.sampling import sample, sample_contact, sample_states
from spacerobot.support.jit import numba

LATER: tuple[Any, ...] = (sample_states, sample_contact, sample)
"""What the callers of `integrate` need after it."""

FLOATS, INTS, MATRIX = np.zeros(1), np.zeros(1, dtype=np.int64), np.zeros((1, 1))

LIKE: dict[str, Any] = {
    **dict.fromkeys(("x", "w", "time", "length", "at"), FLOATS),
    **dict.fromkeys(("c", "order"), INTS),
    **dict.fromkeys(("state", "u"), MATRIX),
    "dense": np.zeros((1, 1, 1)),
    "modes": np.zeros((1, 1), dtype=np.int64),
    "laws": LAWS.laws,
    "count": 1,
}
"""What stands under each parameter's name."""


def signature(function: Any) -> tuple[Any, ...]:
    """The types that a compiled function is called with."""
    return tuple(numba().typeof(LIKE[p]) for p in inspect.signature(function.py_func).parameters)


def compile_ahead() -> None:
    """Compile it all, or find that it is kept already."""
    for function in LATER:
        function.compile(signature(function))
