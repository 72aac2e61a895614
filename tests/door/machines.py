"""Small studies of every other kind of machine, two trials each, and the ways in which labs break them."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from tests.diagnosis.parts.helpers_balls import balls
from tests.overlay.studies import axis_study, write_csv

_PLANAR = """<robot name="floater"><link name="deck"><inertial><mass value="10"/>
<inertia ixx="1" iyy="1" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="rod"><inertial><origin xyz="0.3 0 0"/><mass value="1.5"/>
<inertia ixx="0.1" iyy="0.1" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="pivot" type="revolute"><origin xyz="0.2 0 0"/><parent link="deck"/><child link="rod"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"""

_NOISE = 1e-3


def body(folder: Path) -> Path:
    """Two drops of a heavy ball."""
    balls(folder, {"iron": (2.0, 0.0)})
    return folder


def axis(folder: Path) -> Path:
    """A cart on a spring, whose drive and place were logged; twice."""
    return _twice(
        axis_study(folder, stiffness=300.0, baseline="mass = 3.0\ndamping = 4.0\nstiffness = 300.0", seconds=2.0)
    )


def torques(folder: Path) -> Path:
    """A cart without a spring: a balance of forces; twice."""
    return _twice(axis_study(folder, seconds=2.0))


def platform(folder: Path) -> Path:
    """A deck that floats while its arm follows a plan; twice."""
    time = np.linspace(0.0, 8.0, 161)
    random = np.random.default_rng(5)
    swing = np.clip((time - 2.0) / 4.0, 0.0, 1.0)
    angle = 1.2 * swing**3 * (10 - 15 * swing + 6 * swing**2)
    tracks = {}
    for name, speed in (("a", 0.01), ("b", -0.02)):
        noise = _NOISE * random.standard_normal((3, time.size))
        track = {"x": speed * time + noise[0], "y": noise[1], "yaw": -0.1 * angle + noise[2]}
        tracks[name] = {"t": time, **track, "q": angle}
    return floater(folder, tracks, _NOISE)


def floater(
    folder: Path,
    tracks: Mapping[str, Mapping[str, np.ndarray]],
    noise: float,
    *,
    beliefs: str = "",
    apart: bool = False,
) -> Path:
    """A study of the deck of 10 kg and its rod, whose joint follows `q`.

    Args:
        folder: to be made.
        tracks: trial -> its columns t, x, y, yaw and q.
        noise: of the track, as the study states it [m and rad].
        beliefs: further lines of the baseline.
        apart: whether each trial is a condition of its own.
    """
    folder.mkdir(parents=True)
    (folder / "floater.urdf").write_text(_PLANAR)
    trials = []
    for name, columns in tracks.items():
        write_csv(folder / f"{name}.csv", columns)
        condition = f'condition = "{name}"\n' if apart else ""
        trials.append(f'[[trials]]\nid = "{name}"\n{condition}log = "{name}.csv"\n')
    (folder / "study.toml").write_text(
        f"""format = 1
[baseline]
robot = "floater.urdf"
base = "free"
joints = "servo"
gravity = [0, 0, -9.80665]
[baseline.platform]
mass = 10.0
yaw_inertia = 0.5
{beliefs}[streams.log]
time = "t"
[streams.log.channels]
x = {{ is = "base.position.x", sigma = {noise} }}
y = {{ is = "base.position.y", sigma = {noise} }}
yaw = {{ is = "base.yaw", sigma = {noise} }}
q = {{ is = "joint.pivot.reference" }}
"""
        + "".join(trials)
    )
    return folder


def impacts(folder: Path) -> Path:
    """Velocities of a body before and after it met a wall."""
    folder.mkdir()
    random = np.random.default_rng(3)
    for name in ("a", "b"):
        before = random.uniform((-1.0, -2.0, -1.0), (1.0, -0.5, 1.0), (24, 3))
        after = before * (1.0, -0.6, 1.0) + 0.01 * random.standard_normal((24, 3))
        columns = {f"{side}_{a}": v[:, k] for side, v in (("b", before), ("a", after)) for k, a in enumerate("xyw")}
        one, zero = np.ones(24), np.zeros(24)
        columns |= {"nx": zero, "ny": one, "nw": zero, "tx": one, "ty": zero, "tw": zero}
        write_csv(folder / f"{name}.csv", columns)
    names = {"x": "x", "y": "y", "w": "yaw"}
    lines = [f'b_{k} = {{ is = "body.velocity.{a}", moment = "before", use = "input" }}\n' for k, a in names.items()]
    lines += [f'a_{k} = {{ is = "body.velocity.{a}", moment = "after" }}\n' for k, a in names.items()]
    lines += [f'{k}{w} = {{ is = "aux.{n}_{a}", use = "input" }}\n' for k, n in (("n", "normal"), ("t", "tangent"))
              for w, a in names.items()]  # fmt: skip
    (folder / "study.toml").write_text(
        'format = 1\n[baseline]\nbase = "free"\n[baseline.body]\nmass = 1.0\nyaw_inertia = 0.1\n'
        'restitution = "unknown"\n[streams.log]\nkind = "events"\n[streams.log.channels]\n'
        + "".join(lines)
        + '[[trials]]\nid = "a"\nlog = "a.csv"\n[[trials]]\nid = "b"\nlog = "b.csv"\n'
    )
    return folder


MACHINES: dict[str, Callable[[Path], Path]] = {
    "body": body,
    "axis": axis,
    "torques": torques,
    "platform": platform,
    "impacts": impacts,
}

Mutation = Callable[[Path], None]


def mutations() -> st.SearchStrategy[Mutation]:
    """One way of breaking any of them."""
    return st.one_of(
        st.just(one_trial),
        st.builds(rows, st.integers(0, 1), st.sampled_from([0, 1, 2, 3, 5, 9])),
        st.builds(
            filled, st.integers(0, 1), st.integers(0, 12), st.sampled_from(["0", "1", "-0.3", "nan", "", "5e-324"])
        ),
        st.builds(repeated, st.integers(0, 1), st.integers(1, 40)),
        st.builds(sigmas, st.sampled_from([None, "1e-300", "1e-13", "1e-12", "1e9", "0", "nan"])),
        st.builds(without, st.integers(0, 12)),
    )


def one_trial(folder: Path) -> None:
    path = folder / "study.toml"
    path.write_text("[[trials]]".join(path.read_text().split("[[trials]]")[:2]))


def rows(file: int, kept: int) -> Mutation:
    def change(folder: Path) -> None:
        path = _files(folder)[file % len(_files(folder))]
        path.write_text("\n".join(path.read_text().splitlines()[: 1 + kept]) + "\n")

    return change


def filled(file: int, column: int, value: str) -> Mutation:
    def change(folder: Path) -> None:
        path = _files(folder)[file % len(_files(folder))]
        head, *lines = list(csv.reader(path.read_text().splitlines()))
        for line in lines:
            line[column % len(line)] = value
        path.write_text("\n".join(",".join(line) for line in [head, *lines]) + "\n")

    return change


def repeated(file: int, row: int) -> Mutation:
    """One row's first cell, a time, is that of the row before."""

    def change(folder: Path) -> None:
        path = _files(folder)[file % len(_files(folder))]
        lines = path.read_text().splitlines()
        at = min(row, len(lines) - 1)
        if at > 1:
            lines[at] = ",".join([lines[at - 1].split(",")[0], *lines[at].split(",")[1:]])
        path.write_text("\n".join(lines) + "\n")

    return change


def sigmas(value: str | None) -> Mutation:
    def change(folder: Path) -> None:
        path = folder / "study.toml"
        path.write_text(re.sub(r", sigma = [^ }]+", "" if value is None else f", sigma = {value}", path.read_text()))

    return change


def without(channel: int) -> Mutation:
    def change(folder: Path) -> None:
        path = folder / "study.toml"
        lines = path.read_text().splitlines()
        named = [k for k, line in enumerate(lines) if '{ is = "' in line]
        if len(named) > 1:
            del lines[named[channel % len(named)]]
        path.write_text("\n".join(lines) + "\n")

    return change


def _files(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.csv"))


def _twice(folder: Path) -> Path:
    (folder / "more.csv").write_text((folder / "log.csv").read_text())
    text = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(text + '[[trials]]\nid = "b"\nlog = "more.csv"\n')
    return folder
