"""MAT, HDF5 and NumPy files: arrays by name; hostile files cost a child process and nothing more."""

from __future__ import annotations

import contextlib
import io
import os
import pickle
import zipfile
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from spacerobot.recordings.readers import limits, read_table, sandbox
from spacerobot.recordings.table import Options
from spacerobot.support.errors import InputError, NotFoundError

T = np.linspace(0, 1, 11)
X = np.outer(T, [1.0, 10.0, 100.0])


def test_mat_vectors_matrices_and_structs(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    savemat(path, {"t": T[:, None], "row": T[None, :], "x": X, "data": {"before": X, "deep": {"y": T}}, "name": "rig"})
    table = read_table(path)
    np.testing.assert_array_equal(table["t"], T)
    np.testing.assert_array_equal(table["row"], T)
    np.testing.assert_array_equal(table["x[2]"], X[:, 2])
    np.testing.assert_array_equal(table["data.before[1]"], X[:, 1])
    np.testing.assert_array_equal(table["data.deep.y"], T)


def test_variable_goes_by_index_beside_the_other_vectors(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    savemat(path, {"t": T[:, None], "x": X, "other": np.ones(4)})
    table = read_table(path, Options(variable="x", rows=(1, 4)))
    np.testing.assert_array_equal(table["2"], X[1:4, 2])
    np.testing.assert_array_equal(table["t"], T[1:4])
    with pytest.raises(NotFoundError, match="did you mean 'other'"):
        read_table(path, Options(variable="othr"))


def test_rows_of_a_wide_matrix(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    savemat(path, {"t": T, "states": X.T})
    np.testing.assert_array_equal(read_table(path)["states[1,:]"], X[:, 1])


def test_mat_73_is_hdf5_with_the_axes_swapped(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["x"] = X.T
        file["s/t"] = T[None, :]
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file".ljust(128))
    table = read_table(path)
    np.testing.assert_array_equal(table["x[2]"], X[:, 2])
    np.testing.assert_array_equal(table["s.t"], T)


def test_hdf5_groups_and_compound_datasets(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["mocap/t"] = T
        file["mocap/x"] = X
        file["log"] = np.array([(1.0, 2), (3.0, 4)], dtype=[("a", "f8"), ("b", "i4")])
        file["text"] = "hello"
    table = read_table(path)
    np.testing.assert_array_equal(table["mocap.x[0]"], X[:, 0])
    np.testing.assert_array_equal(table["log.b"], [2, 4])
    assert len(table.columns) == 6


def test_hdf5_leaves_other_files_alone(tmp_path: Path) -> None:
    (tmp_path / "secret.bin").write_bytes(np.ones(4).tobytes())
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["t"] = T
        file.create_dataset("stolen", (4,), "f8", external=[(str(tmp_path / "secret.bin"), 0, 32)])
        file["link"] = h5py.ExternalLink(str(tmp_path / "b.h5"), "/x")
    assert read_table(path).names() == ("t",)


def test_npz_and_npy(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", toss_000=X, toss_001=2 * X)
    np.testing.assert_array_equal(read_table(tmp_path / "a.npz", Options(variable="toss_001"))["1"], 2 * X[:, 1])
    with pytest.raises(NotFoundError, match="toss_00"):
        read_table(tmp_path / "a.npz", Options(variable="tos_000"))
    np.save(tmp_path / "b.npy", X)
    np.testing.assert_array_equal(read_table(tmp_path / "b.npy")["data[1]"], X[:, 1])


class _Trap:
    def __reduce__(self) -> tuple[object, tuple[str]]:
        return os.system, ("touch trapped",)


def test_pickles_are_not_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    np.savez("a.npz", x=np.array([_Trap()], dtype=object))
    with pytest.raises(InputError, match="pickled"):
        read_table(tmp_path / "a.npz")
    np.save("b.npy", np.array([_Trap()], dtype=object))
    with pytest.raises(InputError, match="NumPy file"):
        read_table(tmp_path / "b.npy")
    (tmp_path / "c.npz").write_bytes(pickle.dumps(_Trap()))
    with pytest.raises(InputError):
        read_table(tmp_path / "c.npz", format="npz")
    assert not (tmp_path / "trapped").exists()


def npy(header: str, data: bytes = b"") -> bytes:
    text = header.encode("latin1").ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + data


def test_zip_bomb_is_refused_before_it_is_unpacked(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("x.npy", bytes(limits.ARRAY_VALUES * 8 + 100))
    assert (tmp_path / "a.npz").stat().st_size < 1_000_000
    with pytest.raises(InputError, match="unpacks to too much"):
        read_table(tmp_path / "a.npz")


@pytest.mark.parametrize("shape", ["(1000000000000,)", "(-1,)", "(3, 99999999)"])
def test_header_that_claims_too_much(tmp_path: Path, shape: str) -> None:
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("x.npy", npy(f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}", bytes(80)))
    with pytest.raises(InputError, match="NumPy file"):
        read_table(tmp_path / "a.npz")


def test_hdf5_that_claims_too_much_stays_small(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("x", (10**12,), "f8", chunks=(1000,))
    with pytest.raises(InputError, match="too many numbers"):
        read_table(path)


def test_slow_file_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    savemat(tmp_path / "a.mat", {"t": T})
    monkeypatch.setattr(limits, "CHILD_SECONDS", 0.01)
    with pytest.raises(InputError, match="took longer"):
        read_table(tmp_path / "a.mat")


def test_memory_of_the_child_is_limited(tmp_path: Path) -> None:
    code = (
        "from spacerobot.recordings.readers import child, limits; limits.CHILD_BYTES = 50_000_000; child.restrain()\n"
        "try: bytearray(200_000_000)\nexcept MemoryError: print('held')"
    )
    import subprocess
    import sys

    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "held\n"


def test_one_child_serves_many_trials(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    savemat(tmp_path / "a.mat", {"t": T})
    read_table(tmp_path / "a.mat")
    monkeypatch.setattr(sandbox, "_ask", lambda *_: pytest.fail("a second child"))
    read_table(tmp_path / "a.mat")


def _samples() -> dict[str, bytes]:
    mat, archive = io.BytesIO(), io.BytesIO()
    savemat(mat, {"t": T, "data": {"x": X}})
    np.savez(archive, t=T, x=X)
    hdf = io.BytesIO()
    with h5py.File(hdf, "w") as file:
        file["g/x"] = X
    return {"a.mat": mat.getvalue(), "a.npz": archive.getvalue(), "a.h5": hdf.getvalue()}


SAMPLES = _samples()


@settings(
    max_examples=150, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(edits=st.lists(st.tuples(st.floats(0, 1), st.binary(min_size=1, max_size=4)), min_size=1, max_size=5),
       cut=st.floats(0.2, 1))  # fmt: skip
def test_damaged_npz_gives_nothing_but_input_errors(
    tmp_path: Path, edits: list[tuple[float, bytes]], cut: float
) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(damaged(SAMPLES["a.npz"], edits, cut))
    with contextlib.suppress(InputError):
        read_table(path, format="npz")


@pytest.mark.parametrize("name", ["a.mat", "a.h5"])
def test_damaged_files_give_nothing_but_input_errors(tmp_path: Path, name: str) -> None:
    random = np.random.default_rng(1)
    refused = 0
    for _ in range(6):
        path = tmp_path / name
        edits = [(float(random.random()), random.bytes(4)) for _ in range(4)]
        path.write_bytes(damaged(SAMPLES[name], edits, 1.0 if random.random() < 0.5 else 0.6))
        refused += 1
        with contextlib.suppress(InputError):
            read_table(path)
            refused -= 1
    assert refused > 0


def damaged(data: bytes, edits: list[tuple[float, bytes]], cut: float) -> bytes:
    found = bytearray(data)
    for where, new in edits:
        start = int(where * (len(found) - len(new)))
        found[start : start + len(new)] = new
    return bytes(found[: int(cut * len(found))])


def test_a_child_that_dies_while_it_answers_is_no_answer(tmp_path: Path) -> None:
    said = b'{"arrays": [["x", [3]]], "notes": []}\n'
    assert sandbox.unpack(said + bytes(24), tmp_path)[0]["x"].tolist() == [0, 0, 0]
    for cut in (b"", b'{"arr', said, said + bytes(17), said + bytes(32)):
        with pytest.raises(InputError, match="gave up"):
            sandbox.unpack(cut, tmp_path)


def test_bytes_are_not_blown_up_to_floats_eight_times_as_long(tmp_path: Path) -> None:
    path = tmp_path / "wide.npy"
    kind = np.dtype([(f"f{i}", "u1") for i in range(200)])
    np.lib.format.open_memmap(path, mode="w+", dtype=kind, shape=(400_000,)).flush()
    with pytest.raises(InputError, match="too large"):
        read_table(path)
