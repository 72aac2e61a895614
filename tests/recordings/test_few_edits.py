"""From a raw folder to a study that check accepts: at most five edited lines beyond what the lab believes."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from spacerobot.cli.main import main
from spacerobot.recordings.dataroot import recordings_folder

DRAFT = "draft = true"
ASKED = (
    '# ? which column drives the axis: joint.axis.torque or .voltage, with use = "input"; where nothing does, '
    "joint.axis.torque = 0 above"
)
COUPLED = [
    [32, 0, 0, 0, 0, 0],
    [0, 32, 0, 0, 0, 0],
    [0, 0, 45, 0, 0, 0],
    [0, 0, 0, -48, 0, 0],
    [0, 0, 0, 0, 45, 0],
    [0, 0, 0, 0, 32, 32],
]
EDITS: dict[str, dict[str, str]] = {
    "newcomer/semicolons": {},
    "newcomer/motive_and_ati": {},
    "real/tiago_arm": {},
    "real/spot_free_floating_arm": {},
    "real/emps": {ASKED: '\n"vir" = { is = "joint.axis.torque", scale = 35.1507, use = "input" }'},
    "real/staubli_tx40": {
        "ratio = [1, 1, 1, 1, 1, 1]   # ?": f"ratio = {COUPLED}   #",
        "torque_per_ampere = 1.0   # ? ": "torque_per_ampere = 1.0   # the log has it in: ",
        "rate = 100.0   # ? ": "rate = 5000.0   # ",
    },
    "real/flexible_link": {ASKED: '\n"v" = { is = "joint.axis.torque", use = "input" }'},
}
"""Folder -> what its draft asks for, and the answer; the line that says it is a draft is deleted in each."""

UNKNOWN = {"# mass =": "mass", "# stiffness =": "stiffness", "# damping =": "damping"}
"""Beliefs may be called unknown: whether check accepts the study does not hang on their numbers."""


def recordings(name: str) -> Path:
    top = recordings_folder()
    if top is None or not (top / name).is_dir():
        pytest.skip(f"{name} is not here: set SPACEROBOT_DATA")
    return top / name


@pytest.mark.parametrize("name", EDITS)
def test_a_raw_folder_is_a_study_after_few_edits(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(recordings(name), folder, copy_function=shutil.copyfile)
    folder.chmod(0o755)
    assert main(["study", "new", str(folder)]) == 0
    file = folder / "study.toml"
    edited, lines = 0, []
    for line in file.read_text().splitlines():
        new = line
        for asked, answer in EDITS[name].items():
            new = new.replace(asked, answer)
        edited += new != line or line.startswith(DRAFT)
        edited += new.count("\n")
        key = next((k for b, k in UNKNOWN.items() if line.startswith(b)), "")
        lines += [] if line.startswith(DRAFT) else [f'{key} = "unknown"' if key else new]
    file.write_text("\n".join(lines) + "\n")
    assert edited <= 5
    capsys.readouterr()
    assert main(["study", "check", str(folder)]) == 0
    said = capsys.readouterr().out
    assert "error" not in said.lower(), said
    assert DRAFT not in said
