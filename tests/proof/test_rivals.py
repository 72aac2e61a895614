"""Rivals are used fairly: on a study without missing physics each finds what it can find."""

from __future__ import annotations

import math
import re

import pytest

from spacerobot.proof.rivals import sysid
from spacerobot.proof.rivals.bare import bare
from spacerobot.proof.rivals.tracks import tracks_of
from spacerobot.recordings.study import Study
from tests.diagnosis.rigs import write_study

TRUE = {"wrist.stiffness": 1071.0}


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    """A rig whose spring is five sigmas stiffer than believed, and nothing else amiss."""
    return write_study(tmp_path_factory.mktemp("rivals"), truth=TRUE)


@pytest.mark.slow
def test_sysid_finds_a_stiffness_and_how_well_it_is_known(study: Study) -> None:
    pytest.importorskip("mujoco.sysid", reason="extra 'proof' is not installed")
    _, says = sysid._identified(study, tracks_of(study))
    found = re.search(r"stiffness (\S+) \+- (\S+),", says)
    assert found is not None, says
    value, width = float(found[1]), float(found[2])
    assert value == pytest.approx(TRUE["wrist.stiffness"], rel=0.01)
    assert math.isfinite(width)
    assert 0.0 < width < 20.0


def test_the_bare_refit_moves_the_value_that_is_wrong(study: Study) -> None:
    opinion = bare(study, tracks_of(study))
    assert opinion.flagged
    assert "wrist.stiffness" in opinion.says
    assert opinion.held_out["wrist.x"] < 2.5e-4
