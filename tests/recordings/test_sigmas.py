"""`[baseline.sigma]`: a share of the value, or a size with its unit; a zero can only have the second."""

from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot.recordings.check import check_study
from spacerobot.recordings.ranges import Limits
from spacerobot.recordings.study import Study, load_study
from spacerobot.support.errors import InputError

HEAD = """format = 1
[baseline]
robot = "pa10_wrist"
[baseline.wrist]
mass = 0.8
preload = {preload}
[baseline.joint.a]
damping = 0.0
[baseline.sigma]
{sigma}
[streams.log]
time = "t"
[streams.log.channels]
"x" = {{ is = "target.x" }}
[[trials]]
id = "1"
log = "1.csv"
"""


def study(folder: Path, sigma: str, preload: float = 0.0) -> Study:
    (folder / "1.csv").write_text("t,x\n0,0\n0.1,1\n0.2,2\n")
    (folder / "study.toml").write_text(HEAD.format(sigma=sigma, preload=preload))
    return load_study(folder)


@pytest.mark.parametrize(
    ("line", "name", "size"),
    [
        ('wrist.preload = "0.5 N"', "wrist.preload", 0.5),
        ('wrist.preload = "20 mN"', "wrist.preload", 0.02),
        ('joint.a.zero = "2 mrad"', "joint.a.zero", 0.002),
        ('joint.a.zero = "0.1 mm"', "joint.a.zero", 1e-4),
        ('joint.a.bias = "0.2 N m"', "joint.a.bias", 0.2),
        ('joint.a.damping = "0.3 N s/m"', "joint.a.damping", 0.3),
    ],
)
def test_a_size_of_what_is_believed_zero(tmp_path: Path, line: str, name: str, size: float) -> None:
    found = study(tmp_path, line)
    assert found.absolute == {name: pytest.approx(size)}
    assert found.values()[name] == 0.0
    assert name not in found.sigma


def test_a_size_of_what_is_not_zero_is_a_share(tmp_path: Path) -> None:
    found = study(tmp_path, 'wrist.mass = "8 g"\nwrist.preload = "0.1 N"', preload=-2.0)
    assert found.sigma == {"wrist.mass": pytest.approx(0.01), "wrist.preload": pytest.approx(0.05)}
    assert not found.absolute


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('wrist.preload = "0.5 kg"', "mass"),
        ('wrist.preload = "much"', "no number with a unit"),
        ('wrist.preload = "-1 N"', "above 0"),
        ('wrist.preload = "inf N"', "above 0"),
        ('wrist.preload = "0.5"', "unit"),
        ('wrist.stiffness = "5 N/m"', "needs the value itself"),
        ('joint.a.damping = "5 N"', "another unit"),
        ('wrist.nothing = "5 N"', "value"),
        ("wrist.preload = 0.05", "a share of 0 is 0"),
    ],
)
def test_refused_with_the_line(tmp_path: Path, line: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        study(tmp_path, line)
    assert "study.toml:10" in str(caught.value)


def test_what_no_model_reads_is_said(tmp_path: Path) -> None:
    found = study(tmp_path, 'wrist.preload = "0.5 N"\ntarget.contact_point.lateral = "1 mm"')
    (said,) = (w for w in check_study(found)["warnings"] if "no model reads it" in w)
    assert "wrist.preload" in said
    assert "lateral" not in said


@pytest.mark.parametrize(("size", "told"), [("2 deg", False), ("5 deg", True)])
def test_a_zero_that_a_line_does_not_hold_is_told(tmp_path: Path, size: str, told: bool) -> None:
    found = study(tmp_path, f'joint.a.zero = "{size}"')
    said = [w for w in check_study(found)["warnings"] if "linear in a zero" in w]
    assert bool(said) is told
    assert not [w for w in check_study(found, {"a": Limits(slides=True)})["warnings"] if "linear in a zero" in w]
