"""Studies as labs break them: rows, trials and channels gone, sigmas odd, columns constant, names changed."""

from __future__ import annotations

import csv
import re
import shutil
from collections.abc import Callable
from pathlib import Path

from hypothesis import strategies as st

SOURCE = Path(__file__).resolve().parents[2] / "examples" / "studies" / "guide-friction"
TRIALS = 3

Mutation = Callable[[Path], None]


def small(folder: Path) -> Path:
    """A copy of the bundled wrist study with its first three trials."""
    shutil.copytree(SOURCE, folder)
    head, *trials = (folder / "study.toml").read_text().split("[[trials]]")
    (folder / "study.toml").write_text("[[trials]]".join([head, *trials[:TRIALS]]))
    return folder


def drop_rows(file: str, kept: int) -> Mutation:
    def change(folder: Path) -> None:
        lines = (folder / file).read_text().splitlines()
        (folder / file).write_text("\n".join(lines[: 1 + kept]) + "\n")

    return change


def drop_trials(kept: int) -> Mutation:
    def change(folder: Path) -> None:
        head, *trials = (folder / "study.toml").read_text().split("[[trials]]")
        (folder / "study.toml").write_text("[[trials]]".join([head, *trials[:kept]]))

    return change


def drop_stream(stream: str, trial: str) -> Mutation:
    return replaced(f'\n{stream} = "{trial}_{stream}.csv"', "")


def constant(file: str, column: int, value: str) -> Mutation:
    def change(folder: Path) -> None:
        with (folder / file).open() as stream:
            head, *rows = list(csv.reader(stream))
        for row in rows:
            row[column % len(row)] = value
        with (folder / file).open("w", newline="") as stream:
            csv.writer(stream).writerows([head, *rows])

    return change


def sigma(channel: str, value: str | None) -> Mutation:
    new = "" if value is None else f", sigma = {value}"
    return replaced(rf'(is = "{re.escape(channel)}"), sigma = [^ }}]*', rf"\1{new}")


def renamed(channel: str, name: str) -> Mutation:
    return replaced(rf'is = "{re.escape(channel)}"', f'is = "{name}"')


def believed(key: str, value: str) -> Mutation:
    return replaced(rf"\n{re.escape(key)} = [^\n]*", "" if value == "gone" else f"\n{key} = {value}")


def replaced(pattern: str, text: str) -> Mutation:
    def change(folder: Path) -> None:
        path = folder / "study.toml"
        path.write_text(re.sub(pattern, text, path.read_text()))

    return change


_FILES = st.sampled_from([f"{t:02d}_{s}.csv" for t in (1, 2) for s in ("mocap", "force")])
_CHANNELS = st.sampled_from(["target.x", "wrist.x", "contact.force"])
_NAMES = st.sampled_from(
    ["aux.temperature", "joint.S1.position", "target.yaw", "target.y", "hand.x", "body.x", "contact.force", "base.yaw"]
)
_SIGMAS = st.sampled_from([None, "1e-300", "1e-13", "1e-12", "1e-9", "1e9", "1e300", "0", "-1", "nan", "inf"])


def mutations() -> st.SearchStrategy[Mutation]:
    """One way of breaking a study."""
    return st.one_of(
        st.builds(drop_rows, _FILES, st.sampled_from([0, 1, 2, 3, 4, 5, 7, 8, 30])),
        st.builds(drop_trials, st.integers(0, 2)),
        st.builds(drop_stream, st.sampled_from(["mocap", "force"]), st.sampled_from(["01", "02"])),
        st.builds(constant, _FILES, st.integers(0, 2), st.sampled_from(["0", "1", "-0.05", "nan", "1e300", ""])),
        st.builds(sigma, _CHANNELS, _SIGMAS),
        st.builds(renamed, _CHANNELS, _NAMES),
        st.builds(
            believed,
            st.sampled_from(["mass", "stiffness", "damping", "target.mass", '"wrist.mass"', "base", "joints"]),
            st.sampled_from(["gone", "0", "1e-12", "1e12", "nan", "-1", '"unknown"', '"free"']),
        ),
    )
