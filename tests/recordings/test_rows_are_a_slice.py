"""`rows = [a, b]` of any reader is the whole file, sliced: no row more, none less, each from its own line."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import openpyxl
import pytest
from scipy.io import savemat

from spacerobot.recordings.readers import READERS, read_table
from spacerobot.recordings.table import Options, RawTable
from tests.recordings.test_bags import write_bag
from tests.recordings.test_motive_export import NEW, OLD
from tests.recordings.test_nexus_export import DEVICES

N = 10
T = 0.1 * np.arange(N)
X = np.column_stack([1.0 + T, 100.0 * T**2, -T])

SLICES = [(0, None), (0, 1), (0, 4), (1, 4), (3, None), (3, N), (N - 1, None), (0, N), (2, N - 1), (4, 40)]


def csv(path: Path) -> RawTable:
    lines = ["t,x,y,z", *(",".join(map(repr, map(float, (t, *x)))) for t, x in zip(T, X))]
    path.write_text("\n".join([*lines[:4], "# a remark", "", *lines[4:]]) + "\n")
    return read_table(path)


def csv_with_gaps(path: Path) -> RawTable:
    path.write_text("t;x\n" + "".join(f"{t};{'' if k % 3 == 1 else k}\n" for k, t in enumerate(T)))
    return read_table(path)


def text(path: Path) -> RawTable:
    path.write_text("".join(f"  {t:.3f}   {x[0]!r} {x[1]!r}\n" for t, x in zip(T, X.tolist())))
    return read_table(path, format="text")


def npz(path: Path) -> RawTable:
    np.savez(path, t=T, x=X, row=T[None, :])
    return read_table(path)


def npy(path: Path) -> RawTable:
    np.save(path, X)
    return read_table(path)


def mat(path: Path) -> RawTable:
    savemat(path, {"t": T[:, None], "x": X, "deep": {"y": T}})
    return read_table(path)


def hdf5(path: Path) -> RawTable:
    with h5py.File(path, "w") as file:
        file["t"], file["group/x"] = T, X
    return read_table(path)


def motive(path: Path) -> RawTable:
    path.write_text(OLD + "".join(f"{k},{0.0083 * k:.4f},0.2,0.98,{1000 + k},21,0.3,,,\n" for k in range(3, N)))
    return read_table(path)


def motive_new(path: Path) -> RawTable:
    path.write_text(NEW + "".join(f"{k},{0.01 * k:.2f},1,2,{k},4\n" for k in range(2, N)))
    return read_table(path)


def nexus(path: Path) -> RawTable:
    path.write_text(DEVICES + "".join(f"{k // 5 + 1},{k % 5},{k},2,,4\n" for k in range(N)))
    return read_table(path)


def workbook(path: Path) -> RawTable:
    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet is not None
    for row in (["t", "x", "y"], *np.column_stack([T, X[:, :2]]).tolist()):
        sheet.append(row)
    book.save(path)
    return read_table(path)


def bag(path: Path) -> RawTable:
    return read_table(write_bag(path, "ros1"), Options(variable="/joint_states"))


WRITTEN = {
    "a.csv": (csv, "csv"),
    "gaps.csv": (csv_with_gaps, "csv"),
    "a.txt": (text, "text"),
    "a.npz": (npz, "npz"),
    "a.npy": (npy, "npz"),
    "a.mat": (mat, "mat"),
    "a.h5": (hdf5, "hdf5"),
    "take.csv": (motive, "motive"),
    "new.csv": (motive_new, "motive"),
    "trial.csv": (nexus, "nexus"),
    "a.xlsx": (workbook, "xlsx"),
    "a.bag": (bag, "bag"),
}


def test_no_reader_is_forgotten() -> None:
    assert {name for _, name in WRITTEN.values()} == {reader.name for reader in READERS}


@pytest.mark.parametrize("name", WRITTEN)
def test_rows_are_those_of_the_whole_file(tmp_path: Path, name: str) -> None:
    write, kind = WRITTEN[name]
    path = tmp_path / name
    whole = write(path)
    variable = "/joint_states" if kind == "bag" else None
    assert max(len(c.values) for c in whole.columns) == N
    for first, last in SLICES[:4] if kind in ("bag", "mat", "hdf5", "xlsx") else SLICES:
        part = read_table(path, Options(rows=(first, last), variable=variable), format=kind)
        assert part.names() == whole.names()
        for one, all_ in zip(part.columns, whole.columns, strict=True):
            np.testing.assert_array_equal(one.values, all_.values[first:last])
            assert one.unit == all_.unit
        if whole.lines is not None:
            assert part.lines is not None
            np.testing.assert_array_equal(part.lines, whole.lines[first:last])


@pytest.mark.parametrize(("first", "last"), SLICES)
def test_rows_of_one_variable_too(tmp_path: Path, first: int, last: int | None) -> None:
    np.savez(tmp_path / "a.npz", t=T, x=X, other=np.ones(4))
    part = read_table(tmp_path / "a.npz", Options(variable="x", rows=(first, last), wanted=frozenset({"t"})))
    for j in range(3):
        np.testing.assert_array_equal(part[str(j)], X[first:last, j])
    np.testing.assert_array_equal(part["t"], T[first:last])
