"""What a second process compiles is what the readers of a run would have compiled themselves."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from spacerobot.simulation.reduced.ahead import LATER, LIKE, signature

_PROGRAM = """
import numpy as np

from spacerobot.simulation.reduced.ahead import LATER, compile_ahead
from spacerobot.simulation.reduced.run import simulate
from spacerobot.simulation.rig import rig

compile_ahead()
asked = {f: set(f.overloads) for f in LATER}
run = simulate(rig({}), position={"target": -0.01}, velocity={"target": 0.07}, end=0.5)
at = np.linspace(0.0, 0.5, 9)
run.positions(at), run.contact_at(at), run.sample(at)
late = [f.py_func.__name__ for f in LATER if set(f.overloads) != asked[f]]
print("compiled again:", late)
raise SystemExit(bool(late))
"""


def test_every_parameter_has_a_type() -> None:
    for function in LATER:
        assert len(signature(function)) == function.py_func.__code__.co_argcount
    known = {name for f in LATER for name in f.py_func.__code__.co_varnames[: f.py_func.__code__.co_argcount]}
    assert set(LIKE) == known


@pytest.mark.slow
def test_its_readers_compile_none_of_it_again(tmp_path: Path) -> None:
    """From an empty cache: half a minute of compiler."""
    environment = {**os.environ, "SPACEROBOT_CACHE": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", _PROGRAM], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
