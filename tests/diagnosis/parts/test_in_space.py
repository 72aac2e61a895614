"""Bodies that nothing carries: thrown, they fly in three directions, and what resists them acts against all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from spacerobot.diagnosis.diagnose import diagnose
from spacerobot.diagnosis.machines.body_axes import flies
from spacerobot.diagnosis.machines.choose import models_for
from spacerobot.diagnosis.selection.meetings import meetings
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate
from spacerobot.effects.registry import effect
from spacerobot.recordings.study import Study, load_study
from spacerobot.simulation.reduced.run import simulate

DOWN = np.array([0.0, 0.0, -9.80665])
MASS, CAMERA = 0.06, 1e-3
DIRECTIONS = ("target", "target.y", "target.z")


def thrown(
    folder: Path, resists: Callable[[np.ndarray], np.ndarray], *, fall: np.ndarray = DOWN, stated: bool = False
) -> Study:
    """Five throws in all directions, a camera at 120 Hz; `resists` is force by velocity, `fall` what pulls.

    `stated`: whether the study tells the camera's noise.
    """
    random = np.random.default_rng(7)
    time = np.arange(0.0, 1.0, 1.0 / 120.0)
    text = (
        'format = 1\ntitle = "Throws"\n[baseline]\nbase = "free"\ngravity = [0, 0, -9.80665]\n'
        f"[baseline.body]\nmass = {MASS}\n"
        '[streams.camera]\ntime = "t"\n[streams.camera.channels]\n'
    )
    noise = f", sigma = {CAMERA}" if stated else ""
    text += "".join(f'{a} = {{ is = "body.position.{a}"{noise} }}\n' for a in "xyz")
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


@pytest.mark.parametrize(
    ("name", "power", "size"),
    [
        pytest.param("quadratic_drag", 1, 0.004, marks=pytest.mark.slow),
        pytest.param("viscous_drag", 0, 0.03, marks=pytest.mark.slow),
    ],
)
def test_drag_in_the_air_is_one_law_in_three_directions(name: str, power: int, size: float, tmp_path: Path) -> None:
    study = thrown(tmp_path, lambda v: -size * float(np.linalg.norm(v)) ** power * v)
    verdict = diagnose(study, jobs=1).verdict
    assert verdict["verdict"] == "named"
    ((found, parameters),) = [(e["effect"], e["parameters"]) for e in verdict["effects"]]
    assert found == name
    (value,) = parameters.values()
    assert value["value"] == pytest.approx(size, rel=0.03)
    assert set(verdict["held_out"]["channels"]) == {f"body.position.{a}" for a in "xyz"}


@pytest.mark.slow
def test_drag_in_moving_air_is_none_of_the_catalogue(tmp_path: Path) -> None:
    """Against air at rest it would be another law, which leaves several times the camera's noise."""
    wind = np.array([-0.7, -1.1, 0.0])
    study = thrown(tmp_path, lambda v: -0.004 * float(np.linalg.norm(v - wind)) * (v - wind), stated=True)
    verdict = diagnose(study, jobs=1).verdict
    assert verdict["verdict"] in ("unknown", "learned")
    assert not [e for e in verdict["effects"] if e["effect"] != "learned_law"]


@pytest.mark.slow
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


def bouncing(folder: Path, gives_back: float, drag: float = 0.0) -> Study:
    """Five drops on a floor, with a drift sideways; a camera at 120 Hz."""
    random, text = np.random.default_rng(11), ""
    step, fine = 1.0 / 120.0, 40
    for n in range(5):
        place, rate = np.array([0.0, 0.0, random.uniform(0.8, 1.2)]), np.append(random.normal(0.0, 0.5, 2), 0.0)
        rows = []
        for k in range(170):
            rows.append([k * step, *(place + CAMERA * random.standard_normal(3))])
            for _ in range(fine):
                pull = DOWN - drag / MASS * float(np.linalg.norm(rate)) * rate
                rate = rate + pull * step / fine
                place = place + rate * step / fine
                if place[2] < 0.0 and rate[2] < 0.0:
                    rate[2] *= -gives_back
        np.savetxt(folder / f"{n}.csv", rows, delimiter=",", header="t,x,y,z", comments="")
        text += f'[[trials]]\nid = "{n}"\ncondition = "{n}"\ncamera = "{n}.csv"\n'
    head = (folder.parent / "throws" / "study.toml").read_text().split("[[trials]]")[0]
    (folder / "study.toml").write_text(head + text)
    return load_study(folder)


@pytest.fixture
def bounced(tmp_path: Path) -> Path:
    for name in ("throws", "bounced"):
        (tmp_path / name).mkdir()
    thrown(tmp_path / "throws", np.zeros_like)
    return tmp_path / "bounced"


@pytest.mark.slow
def test_a_floor_is_met_and_no_physics_is_missing_in_between(bounced: Path) -> None:
    verdict = diagnose(bouncing(bounced, 0.75), jobs=1).verdict
    assert verdict["verdict"] == "nothing_missing"
    met = {e["trial"] for e in verdict["events"] if e["seen_in"] == "track"}
    assert met == {"0", "1", "2", "3", "4"}


def test_free_flight_meets_nothing(bounced: Path) -> None:
    study = thrown(bounced.parent / "throws", lambda v: -0.004 * float(np.linalg.norm(v)) * v)
    (model,) = models_for(study)
    assert not meetings(model)
