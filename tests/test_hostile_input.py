"""The hostile inputs that everybody names, one test each, with the answer that a user gets."""

from __future__ import annotations

import gzip
import itertools
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import h5py
import numpy as np
import pytest

from spacerobot.cli.main import main
from spacerobot.model.library import load
from spacerobot.model.meshes import mesh_path
from spacerobot.recordings.recording import Recording
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError

STUDY = """format = 1
title = "hostile"
[baseline]
robot = "pa10_wrist"
[baseline.wrist]
mass = 0.7
[streams.mocap]
time = "t"
{keys}
[streams.mocap.channels]
x = {{ is = "target.x", sigma = 1e-4 }}
[[trials]]
id = "01"
target.mass = 9.0
mocap = "{file}"
"""
TABLE = "t,x\n" + "".join(f"{0.01 * i:.2f},{0.001 * i:.4f}\n" for i in range(30))

URDF = """<?xml version="1.0"?>{head}<robot name="good"><link name="base"/>
<link name="arm"><inertial><origin xyz="0 0 0.1"/><mass value="2"/>
<inertia ixx="0.1" iyy="0.1" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry>{shape}</geometry></visual></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="10" velocity="2"/></joint></robot>"""
BOX = '<box size="0.1 0.1 0.1"/>'


def study(folder: Path, content: bytes | str = TABLE, *, file: str = "01.csv", keys: str = "") -> Path:
    """A study's folder with one recording."""
    (folder / "study.toml").write_text(STUDY.format(file=file, keys=keys), encoding="utf-8")
    if "/" not in file and not (folder / file).is_symlink():
        (folder / file).write_bytes(content.encode() if isinstance(content, str) else content)
    return folder


def recorded(folder: Path) -> Recording:
    """The trial, read."""
    return load_study(folder).recording("01")


def refused(folder: Path, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The command answers with exit code 2 and a line for each fault, one of which says `message`."""
    assert main(["study", "check", str(folder), "--json"]) == 2
    said = capsys.readouterr()
    assert message in said.err
    assert all(line.isprintable() and ": " in line for line in said.err.splitlines())
    assert "Traceback" not in said.err


def same_as_plain(recording: Recording) -> None:
    """It holds what TABLE says."""
    np.testing.assert_allclose(recording["target.x"].time, 0.01 * np.arange(30), atol=2e-7)  # doubles of epoch seconds
    np.testing.assert_allclose(recording["target.x"].value, 0.001 * np.arange(30), atol=1e-9)


# XML


def test_entity_bomb() -> None:
    names = [f"e{i}" for i in range(12)]
    bomb = "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in itertools.pairwise(names))
    with pytest.raises(InputError, match="document type or an entity"):
        load(URDF.format(head=f'<!DOCTYPE r [<!ENTITY e0 "ha">{bomb}]>', shape=BOX))


@pytest.mark.parametrize("what", ['SYSTEM "file:///etc/passwd"', 'PUBLIC "-//X" "http://example.com/x"'])
def test_external_entity(what: str) -> None:
    with pytest.raises(InputError, match="document type or an entity"):
        load(URDF.format(head=f"<!DOCTYPE r [<!ENTITY x {what}>]>", shape=BOX))


def test_xinclude_is_not_followed() -> None:
    text = URDF.format(head="", shape=BOX).replace(
        "<link name=", '<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="/etc/passwd"/><link name=', 1
    )
    assert "root:" not in load(text).urdf


@pytest.mark.parametrize("name", ["../../x.stl", "/etc/passwd", "file:///etc/passwd", "package://a/../../x.stl",
                                  "package://a/%2e%2e/%2e%2e/x.stl", "http://example.com/x.stl"])  # fmt: skip
def test_mesh_outside(tmp_path: Path, name: str) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(URDF.format(head="", shape=f'<mesh filename="{name}"/>'))
    with pytest.raises(InputError, match="mesh of link 'arm'"):
        load(path)


def test_mesh_through_a_link(tmp_path: Path) -> None:
    inner = tmp_path / "robot"
    inner.mkdir()
    (tmp_path / "secret.stl").write_text("solid")
    os.symlink(tmp_path / "secret.stl", inner / "arm.stl")
    with pytest.raises(InputError, match="through a link"):
        mesh_path("arm.stl", (inner,))


# paths of recordings


@pytest.mark.parametrize("file", ["../outside.csv", "/etc/passwd", "a/../../outside.csv"])
def test_stream_outside(tmp_path: Path, file: str, capsys: pytest.CaptureFixture[str]) -> None:
    inner = tmp_path / "study"
    inner.mkdir()
    (tmp_path / "outside.csv").write_text(TABLE)
    refused(study(inner, file=file), "leaves the data folder", capsys)


@pytest.mark.parametrize("target", ["/etc/passwd", "../outside.csv", "01.csv"])
def test_stream_through_a_link(tmp_path: Path, target: str, capsys: pytest.CaptureFixture[str]) -> None:
    inner = tmp_path / "study"
    inner.mkdir()
    (tmp_path / "outside.csv").write_text(TABLE)
    os.symlink(target, inner / "01.csv")
    refused(study(inner), "no such file" if target == "01.csv" else "leaves the data folder", capsys)


def test_a_pipe_and_a_device_are_no_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study(tmp_path)
    (tmp_path / "01.csv").unlink()
    os.mkfifo(tmp_path / "01.csv")
    refused(tmp_path, "no such file", capsys)


# floods


_MEASURED = """
import resource, sys
from spacerobot.recordings.study import load_study
from spacerobot.support.errors import InputError
try:
    load_study(sys.argv[1]).recordings()
except InputError as error:
    print(error)
# not ru_maxrss of itself: that begins with the size of the process that started it
own = next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM"))
print(1024 * max(own, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
"""


def answered_below_a_gigabyte(folder: Path, message: str) -> None:
    """A process of its own says `message`, and neither it nor its children take 1 GB."""
    done = subprocess.run(
        [sys.executable, "-c", _MEASURED, str(folder)], capture_output=True, text=True, check=True, timeout=120
    )
    *said, most = done.stdout.splitlines()
    assert message in " ".join(said)
    assert int(most) < 1_000_000_000


def test_a_file_of_gigabytes(tmp_path: Path) -> None:
    study(tmp_path)
    with (tmp_path / "01.csv").open("r+b") as stream:
        stream.truncate(5_000_000_000)
    answered_below_a_gigabyte(tmp_path, "too long")


def test_a_field_of_a_hundred_megabytes(tmp_path: Path) -> None:
    answered_below_a_gigabyte(study(tmp_path, TABLE + "0.3," + "1" * 100_000_000 + "\n"), "line is too long")


def test_an_hdf5_field_that_claims_terabytes(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "01.h5", "w") as file:
        file.create_dataset("x", (2**40,), "f8", chunks=(1000,))
    content = (tmp_path / "01.h5").read_bytes()
    answered_below_a_gigabyte(study(tmp_path, content, file="01.h5"), "too many numbers")


def test_gzip_bomb(tmp_path: Path) -> None:
    bomb = gzip.compress(bytes(1_000_000_000), 1)
    answered_below_a_gigabyte(study(tmp_path, bomb, file="01.csv.gz"), "too long")


def test_zip_bomb(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "01.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        head = np.lib.format.magic(1, 0) + b"\x76\x00"
        shape = b"{'descr': '<f8', 'fortran_order': False, 'shape': (125000000,), }"
        with archive.open("x.npy", "w") as member:
            member.write(head + shape.ljust(0x75) + b"\n")
            for _ in range(1000):
                member.write(bytes(1_000_000))
    answered_below_a_gigabyte(study(tmp_path, (tmp_path / "01.npz").read_bytes(), file="01.npz"), "unpacks to too much")


def test_hdf5_filter_bomb(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "01.h5", "w") as file:
        data = file.create_dataset("x", (10, 19_000_000), "u1", chunks=(1, 19_000_000), compression="gzip")
        data[:] = 0
    answered_below_a_gigabyte(study(tmp_path, (tmp_path / "01.h5").read_bytes(), file="01.h5"), "too many numbers")


def test_nan_flood(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    flood = "t,x\n" + "".join(f"{0.01 * i:.2f},nan\n" for i in range(5000))
    refused(study(tmp_path, flood), "target.x is missing nearly everywhere", capsys)
    refused(study(tmp_path, flood.replace("0.05,nan", "0.05,1")), "missing nearly", capsys)


# encodings and conventions


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-32"])
def test_byte_order_marks(tmp_path: Path, encoding: str) -> None:
    same_as_plain(recorded(study(tmp_path, TABLE.encode(encoding))))


def test_utf_16_without_its_mark(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    refused(study(tmp_path, TABLE.encode("utf-16-le")), "UTF-16 without its mark", capsys)
    same_as_plain(recorded(study(tmp_path, TABLE.encode("utf-16-le"), keys='encoding = "utf-16-le"')))


@pytest.mark.parametrize("end", ["\r\n", "\r"])
def test_line_ends(tmp_path: Path, end: str) -> None:
    same_as_plain(recorded(study(tmp_path, TABLE.replace("\n", end))))


def test_duplicate_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    twice = TABLE.replace("t,x", "t,x,x").replace("\n", ",7\n").replace("t,x,x,7", "t,x,x")
    refused(study(tmp_path, twice), "same name", capsys)


def test_decimal_commas(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    german = TABLE.replace(",", ";").replace(".", ",")
    same_as_plain(recorded(study(tmp_path, german)))
    refused(study(tmp_path, german, keys='decimal = "."'), "unknown column of 01.csv", capsys)


def test_time_running_backwards(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    refused(study(tmp_path, TABLE + "0.05,0.005\n"), "01.csv:32: time runs backwards", capsys)


def test_epoch_seconds(tmp_path: Path) -> None:
    lines = [f"{1_700_000_000 + 0.01 * i:.2f},{0.001 * i:.4f}" for i in range(30)]
    found = recorded(study(tmp_path, "t,x\n" + "\n".join(lines)))
    same_as_plain(found)
    assert found.epoch == {"shared": 1_700_000_000}


SCRIPT = "<script>alert(1)</script><img src=x onerror=alert(1)>\\u0007"


def test_a_title_with_a_script(tmp_path: Path) -> None:
    """The page of `overlay` shows it as text; reports and scenes are tested beside their pages, in a browser too."""
    from spacerobot.recordings.study import resolve_study

    source = resolve_study("guide-friction")
    text = source.read_text(encoding="utf-8")
    title = next(line for line in text.splitlines() if line.startswith("title"))
    (tmp_path / "study.toml").write_text(text.replace(title, f'title = "{SCRIPT}"'), encoding="utf-8")
    for file in source.parent.glob("03_*.csv"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    out = tmp_path / "out"
    assert main(["overlay", str(tmp_path), "--trials", "03", "--out", str(out)]) == 0
    page = (out / "overlay.html").read_text(encoding="utf-8")
    assert "alert(1)" in page
    assert "<script>alert" not in page
    assert "<img src=x" not in page
    assert sorted(p.name for p in tmp_path.iterdir() if p.is_dir()) == ["out"]


def test_the_measure_of_memory_can_fail() -> None:
    child = "import subprocess, sys; subprocess.run([sys.executable, '-c', 'bytearray(700_000_000)'])\n"
    measured = "import resource\n" + child + _MEASURED[_MEASURED.index("# not ru_maxrss") :]
    for code in (measured, measured.replace(child, "bytearray(700_000_000)\n")):
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert int(done.stdout) > 600_000_000
