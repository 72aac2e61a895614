"""Compiling what the integrator calls, in a process that has nothing else to do meanwhile.

The first run after an installation waits for the compiler. Compiled functions are kept on disk as they are finished, so
that another process may take a part of them off this one's hands.
"""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np

from spacerobot.simulation.reduced.affine import advance, series, shorten, straight, system
from spacerobot.simulation.reduced.crossings import first_fall, linear_guards
from spacerobot.simulation.reduced.edges import first_edge
from spacerobot.simulation.reduced.events import find_event, switch
from spacerobot.simulation.reduced.law_table import LAWS
from spacerobot.simulation.reduced.rosenbrock import (
    Room,
    hastiness,
    linearise,
    remembers,
    stiff_dense,
    stiff_norm,
    stiff_stages,
)
from spacerobot.simulation.reduced.sampling import sample_contact, sample_states
from spacerobot.simulation.reduced.stepper import dense, error_norm, stages
from spacerobot.support.jit import numba

LATER: tuple[Any, ...] = (
    straight, system, series, shorten, advance, error_norm, dense, linear_guards, find_event, switch, stages,
    first_fall, first_edge, sample_states, sample_contact,
    remembers, hastiness, linearise, stiff_stages, stiff_norm, stiff_dense,
)  # fmt: skip
"""What `integrate` and its callers need after `start_modes`, which it meets first and compiles itself."""

FLOATS, INTS, MATRIX = np.zeros(1), np.zeros(1, dtype=np.int64), np.zeros((1, 1))

LIKE: dict[str, Any] = {
    **dict.fromkeys(
        ("x", "y", "w", "atol", "new", "temp", "slope", "p", "rates", "time", "length", "at", "scale"), FLOATS
    ),
    **dict.fromkeys(("c", "modes", "owner"), INTS),
    **dict.fromkeys(("a", "held", "q", "k", "u", "g", "samples", "state"), MATRIX),
    **dict.fromkeys(("t", "h", "rtol", "part", "theta"), 1.0),
    **dict.fromkeys(("i", "count", "mode"), 1),
    "even": True,
    "o": Room(MATRIX, MATRIX, FLOATS, FLOATS, MATRIX),
    "laws": LAWS.laws,
}
"""What stands under each parameter's name, wherever it occurs."""

OTHERS: dict[tuple[str, str], Any] = {
    ("sample_states", "dense"): np.zeros((1, 1, 1)),
    ("sample_contact", "dense"): np.zeros((1, 1, 1)),
    ("sample_states", "order"): INTS,
    ("sample_contact", "order"): INTS,
    ("sample_contact", "modes"): np.zeros((1, 1), dtype=np.int64),
    ("first_fall", "order"): 1,
    ("first_edge", "order"): 1,
    ("find_event", "order"): 1,
    ("linearise", "k"): FLOATS,
}
"""By function and parameter, where the name alone does not say."""


def signature(function: Any) -> tuple[Any, ...]:
    """The types that the integrator calls a compiled function with."""
    name = function.py_func.__name__
    parameters = inspect.signature(function.py_func).parameters
    return tuple(numba().typeof(OTHERS[name, p] if (name, p) in OTHERS else LIKE[p]) for p in parameters)


def compile_ahead() -> None:
    """Compile it all, or find that it is kept already."""
    for function in LATER:
        function.compile(signature(function))
