"""A verdict as a scene: what was found, and the same hit without it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from helpers_report import KINDS, verdict

from spacerobot.cli.main import main
from spacerobot.simulation.parts import Target, Wrist
from spacerobot.simulation.parts.effect_at import EffectAt
from spacerobot.simulation.scene import Scene
from spacerobot.view.scene3d.choose import film_of
from spacerobot.view.scene3d.verdict_film import APART


def written(folder: Path, found: dict, effects: tuple[EffectAt, ...] = ()) -> Path:
    scene = Scene(
        approach=(1.0, 0.0, 0.0),
        wrist=Wrist(stiffness=530.0, damping=2.0),
        target=Target(mass=9.0, speed=0.1, gap=0.02),
        backend="reduced",
        effects=effects,
    )
    (folder / "scene.toml").write_text(scene.to_toml())
    (folder / "verdict.json").write_text(json.dumps(found))
    return folder / "verdict.json"


FRICTION = EffectAt("coulomb_friction", "wrist", {"force_N": 0.4})


def test_the_ghost_is_the_same_hit_without_what_was_found(tmp_path: Path) -> None:
    path = written(tmp_path, verdict("named"), (FRICTION,))
    film = film_of(str(path))
    assert "found Coulomb friction" in film.title
    ghost, target = (next(b for b in film.bodies if b.name == n) for n in ("believed/target", "target"))
    ahead = ghost.poses[:, 0] - target.poses[:, 0]
    assert np.abs(ahead[film.time < film.marks[0].time]).max() < 1e-6, "before the touch they are one"
    assert ahead[-1] < -1e-3, "without friction the target comes back faster"
    assert ghost.mismatch is not None
    np.testing.assert_allclose(ghost.mismatch, np.abs(ahead) / APART, atol=1e-6)
    assert film_of(str(tmp_path)).title == film.title


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_verdict_has_its_words(kind: str, tmp_path: Path) -> None:
    film = film_of(str(written(tmp_path, verdict(kind))))
    assert ": " in film.title
    assert not [b for b in film.bodies if b.kind == "ghost"]


@pytest.mark.parametrize("text", ["", "[]", "{", '{"verdict": "named"}'])
def test_what_is_no_verdict_is_refused_in_a_line(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "verdict.json").write_text(text)
    assert main(["view", str(tmp_path / "verdict.json"), "--html", str(tmp_path / "x.html")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "x.html").exists()


def test_a_verdict_without_a_scene_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "verdict.json").write_text(json.dumps(verdict("named")))
    assert main(["view", str(tmp_path / "verdict.json")]) == 2
    assert "no scene" in capsys.readouterr().err
