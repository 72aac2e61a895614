"""Bodies that nothing carries: thrown, they fly in three directions, and what resists them acts against all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.body import flies
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from spacerobot.simulation.reduced.run import simulate

DOWN = np.array([0.0, 0.0, -9.80665])
MASS, CAMERA = 0.06, 1e-3
DIRECTIONS = ("target", "target.y", "target.z")


def thrown(folder: Path, resists: Callable[[np.ndarray], np.ndarray], *, fall: np.ndarray = DOWN) -> Study:
    """Five throws in all directions, a camera at 120 Hz; `resists` is force by velocity, `fall` what pulls."""
    random = np.random.default_rng(7)
    time = np.arange(0.0, 1.0, 1.0 / 120.0)
    text = (
        'format = 1\ntitle = "Throws"\n[baseline]\nbase = "free"\ngravity = [0, 0, -9.80665]\n'
        f"[baseline.body]\nmass = {MASS}\n"
        '[streams.camera]\ntime = "t"\n[streams.camera.channels]\n'
    )
    text += "".join(f'{a} = {{ is = "body.position.{a}" }}\n' for a in "xyz")
    for n in range(5):
        start = np.concatenate([[0.0, 0.0, 1.5], random.normal(size=3) * [3.0, 3.0, 2.0]])
        path = solve_ivp(
            lambda _, s: np.concatenate([s[3:], fall + resists(s[3:]) / MASS]),
            (0.0, 1.0), start, t_eval=time, rtol=1e-9, atol=1e-9,
        ).y[:3]  # fmt: skip
        rows = np.vstack([time, path + CAMERA * random.standard_normal(path.shape)]).T
        np.savetxt(folder / f"{n}.csv", rows, delimiter=",", header="t,x,y,z", comments="")
        text += f'[[trials]]\nid = "{n}"\ncondition = "{n}"\ncamera = "{n}.csv"\n'
    (folder / "study.toml").write_text(text)
    return load_study(folder)


@pytest.mark.parametrize(("name", "power", "size"), [("quadratic_drag", 1, 0.004), ("viscous_drag", 0, 0.03)])
def test_drag_in_the_air_is_one_law_in_three_directions(name: str, power: int, size: float, tmp_path: Path) -> None:
    study = thrown(tmp_path, lambda v: -size * float(np.linalg.norm(v)) ** power * v)
    verdict = diagnose(study, jobs=1).verdict
    assert verdict["verdict"] == "named"
    ((found, parameters),) = [(e["effect"], e["parameters"]) for e in verdict["effects"]]
    assert found == name
    (value,) = parameters.values()
    assert value["value"] == pytest.approx(size, rel=0.03)
    assert set(verdict["held_out"]["channels"]) == {f"body.position.{a}" for a in "xyz"}


def test_nothing_is_missing_where_only_gravity_acts(tmp_path: Path) -> None:
    assert diagnose(thrown(tmp_path, np.zeros_like), jobs=1).verdict["verdict"] == "nothing_missing"


def test_what_a_table_carries_does_not_fly(tmp_path: Path) -> None:
    """Its markers are tracked in height too, and stay there."""
    (tmp_path / "air").mkdir()
    (tmp_path / "table").mkdir()
    in_air = thrown(tmp_path / "air", np.zeros_like)
    on_table = thrown(tmp_path / "table", lambda v: -1e3 * MASS * v * [0.0, 0.0, 1.0], fall=np.zeros(3))
    assert flies(in_air, in_air.trials, "body")
    assert not flies(on_table, on_table.trials, "body")


def turned() -> Iterator[np.ndarray]:
    yield from Rotation.random(4, random_state=3).as_matrix()


@pytest.mark.parametrize("name", ["quadratic_drag", "viscous_drag"])
def test_no_direction_is_special(name: str) -> None:
    """The motion of a turned start is the turned motion."""
    still = Mechanism(
        coordinates={n: Coordinate(n, 2.0) for n in DIRECTIONS}, ports={n: {n: 1.0} for n in DIRECTIONS}, forces=()
    )
    drag = effect(name)
    dragged = drag.apply(still, "target", {drag.parameters[0].name: 0.7})

    def end(start: np.ndarray) -> np.ndarray:
        speeds = dict(zip(DIRECTIONS, start.tolist(), strict=True))
        run = simulate(dragged, position={}, velocity=speeds, start=0.0, end=2.0, tolerance=1e-9)
        return np.asarray(run.positions(np.array([2.0]))[0])

    start = np.array([1.0, -0.4, 0.2])
    for turn in turned():
        np.testing.assert_allclose(end(turn @ start), turn @ end(start), atol=1e-7)
