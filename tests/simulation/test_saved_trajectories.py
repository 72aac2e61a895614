"""A saved trajectory from anyone: read whole and consistent, or refused in one line; never a flood."""

from __future__ import annotations

import contextlib
import io
import json
import os
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from spacerobot.simulation.trajectory import Trajectory
from spacerobot.support.errors import InputError

T = np.arange(3.0)
ABOUT: dict[str, Any] = {
    "format": 1,
    "backend": "reduced",
    "units": {"target.x": "m"},
    "events": [["contact", "touch"]],
    "restitution": {
        "target": 0.7, "hand": 0.7, "point": None, "first_touch": "inf", "last_separation": 1.0, "contact_time": 1.0,
        "contact_time_summed": 1.0, "touches": 1,
    },
    "scene": "format = 1",
    "notes": ["a"],
}  # fmt: skip
ARRAYS = {
    "time": T, "channel/target.x": T, "measured/target.x": T, "ledger/time": T, "ledger/kinetic": T, "stored/spring": T,
    "work/spring": T, "event/time": np.array([0.5]),
}  # fmt: skip


def written(path: Path, said: object = ABOUT, **arrays: np.ndarray) -> Path:
    """A file with some of its parts replaced."""
    about = np.frombuffer(json.dumps(said).encode(), dtype=np.uint8)
    np.savez(path, **{**ARRAYS, "about": about, **arrays})
    return path


def test_the_good_one_is_good(tmp_path: Path) -> None:
    found = Trajectory.load(written(tmp_path / "a.npz"))
    assert found.restitution.first_touch == np.inf
    assert np.isnan(found.restitution.point)
    assert found.events[0].kind == "touch"
    assert found.ledger.stored["spring"].tolist() == [0, 1, 2]


ABOUTS = {
    "format": 2, "backend": "magic", "units": {}, "events": [["contact"]], "restitution": {"target": "soon"},
    "scene": 7, "notes": "a",
}  # fmt: skip


@pytest.mark.parametrize("key", ABOUTS)
def test_what_it_says_of_itself_is_checked(tmp_path: Path, key: str) -> None:
    with pytest.raises(InputError, match="not a trajectory"):
        Trajectory.load(written(tmp_path / "a.npz", {**ABOUT, key: ABOUTS[key]}))
    with pytest.raises(InputError, match="not a trajectory"):
        Trajectory.load(written(tmp_path / "b.npz", {k: v for k, v in ABOUT.items() if k != key}))


BAD = {
    "channel of another length": {"channel/target.x": np.arange(4.0)},
    "channel of text": {"channel/target.x": np.array(["a", "b", "c"])},
    "channel of two dimensions": {"channel/target.x": np.ones((3, 2))},
    "complex channel": {"channel/target.x": T * 1j},
    "time runs backwards": {"time": np.array([0.0, 2.0, 1.0])},
    "time with a gap": {"time": np.array([0.0, np.nan, 1.0])},
    "no time at all": {"time": np.array([])},
    "more events than times": {"event/time": np.array([])},
    "ledger of another length": {"work/spring": np.arange(2.0)},
    "what it says is no text": {"about": np.array([1.0, 2.0])},
    "deep nesting": {"about": np.frombuffer(b"[" * 100_000, dtype=np.uint8)},
}


@pytest.mark.parametrize("name", BAD)
def test_arrays_are_checked(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="not a trajectory"):
        Trajectory.load(written(tmp_path / "a.npz", **BAD[name]))


def npy(shape: str) -> bytes:
    """The beginning of a .npy file that claims a shape."""
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"
    header += " " * (-(len(header) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode()


def test_an_archive_that_unpacks_to_gigabytes_is_not_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "bomb.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("time.npy", "w") as member:
        member.write(npy("(25000000,)"))
        for _ in range(200):
            member.write(bytes(1_000_000))
    assert path.stat().st_size < 1_000_000
    with pytest.raises(InputError, match="unpacks to too much"):
        Trajectory.load(path)


def test_an_archive_of_a_million_members_is_not_listed(tmp_path: Path) -> None:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for i in range(20_000):
            archive.writestr(f"a{i}", b"")
    (tmp_path / "many.npz").write_bytes(buffer.getvalue())
    with pytest.raises(InputError, match="too many members"):
        Trajectory.load(tmp_path / "many.npz")


def test_a_pipe_is_no_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "run.npz")
    with pytest.raises(InputError, match="no such file"):
        Trajectory.load(tmp_path / "run.npz")


values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
junk = hnp.arrays(
    hnp.floating_dtypes() | hnp.integer_dtypes() | hnp.complex_number_dtypes() | hnp.unicode_string_dtypes(max_len=3),
    hnp.array_shapes(min_dims=0, max_dims=2, min_side=0, max_side=4),
)


@settings(
    max_examples=200, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    about=st.dictionaries(st.sampled_from([*ABOUT, "x"]), values, max_size=2),
    arrays=st.dictionaries(st.sampled_from([*ARRAYS, "about", "channel/", "stored/x", "y"]), junk, max_size=2),
)
def test_any_part_replaced_by_anything_is_read_or_refused(
    tmp_path: Path, about: dict[str, Any], arrays: dict[str, np.ndarray]
) -> None:
    path = written(tmp_path / "a.npz", {**ABOUT, **about}, **arrays)
    with contextlib.suppress(InputError):
        found = Trajectory.load(path)
        assert all(c.shape == found.time.shape for c in found.channels.values())
        found.save(tmp_path / "again.npz")
