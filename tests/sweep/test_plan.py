"""What a sweep file says: numbering, draws, and every mistake in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from spacerobot.simulation.simulate import simulate
from spacerobot.support.errors import InputError
from spacerobot.sweep.engine import EXACT, INTEGRATED, ONE_BY_ONE, Engine
from spacerobot.sweep.keys import KEYS, value_of, with_values
from spacerobot.sweep.scatter import Scatter, uniforms
from spacerobot.sweep.sweep_file import plan_from_text

pytest.importorskip("pyarrow", reason="extra 'scale' is not installed")

from tests.sweep.helpers_sweep import SWEEP, TOTAL

HERE = Path(".")


def engine(text: str) -> Engine:
    return Engine(plan_from_text(text, HERE))


def test_numbering_is_the_file_s_order_with_repeats_fastest() -> None:
    plan = plan_from_text(SWEEP.replace('"target.speed" = { normal', '"wrist.mass" = { normal'), HERE)
    assert plan.total == TOTAL
    assert plan.parts == -(-TOTAL // 64)
    pose, values = plan.columns(0, plan.total)
    assert (np.diff(pose) >= 0).all()
    assert pose[-1] == 1
    assert (values["wrist.stiffness"][:20] == 530.0).all()
    assert (values["wrist.stiffness"][20:40] == 1020.0).all()
    assert values["target.speed"][40] == 0.07
    assert values["target.mass"][80] == pytest.approx(np.sqrt(1000.0))


def test_draws_depend_on_the_collision_s_number_alone() -> None:
    whole = uniforms(7, 0, 1000, 3)
    for first, last in ((0, 1), (5, 77), (13, 14), (998, 1000)):
        assert (uniforms(7, first, last, 3) == whole[first:last]).all()
    assert not (uniforms(8, 0, 1000, 3) == whole).any()
    assert whole.mean() == pytest.approx(0.5, abs=0.03)
    assert abs(np.corrcoef(whole.T)[0, 1]) < 0.1


def test_scatter_has_the_spread_it_says() -> None:
    u = uniforms(1, 0, 20_000, 1)[:, 0]
    normal = Scatter("normal", 0.1).spread(np.full(u.size, 5.0), u)
    assert normal.std() == pytest.approx(0.5, rel=0.03)
    assert np.abs(normal - 5.0).max() <= 2.0
    flat = Scatter("uniform", 0.1, absolute=True).spread(np.full(u.size, 5.0), u)
    assert flat.min() == pytest.approx(4.9, abs=1e-3)
    assert flat.max() == pytest.approx(5.1, abs=1e-3)


@pytest.mark.parametrize("key", [k for k in KEYS if k not in ("contact.exponent", "contact.chi_over_k", "contact.mu")])
def test_every_key_does_what_it_does_in_a_scene(key: str) -> None:
    """Swept by the thousand, a number has the effect that it has in a scene made with it."""
    floats = key == "chaser.hand_speed"
    robot = 'robot = "chaser_pa10_wrist"' if floats else ""
    base = plan_from_text(f"[scene]\n{robot}\n[scene.target]\ngap = 0.01", HERE).scene
    value = 1.3 * (value_of(base, key) or {"chaser.hand_speed": 0.05, "target.yaw_inertia": 0.2}.get(key, 0.002))
    text = f"[scene]\n{robot}\n[scene.target]\ngap = 0.01\n[grid]\n{key} = [{value}, {1.1 * value}]"
    found = engine(text)
    assert found.method == EXACT
    columns = found.columns(0, 2)
    for i, own in enumerate((value, 1.1 * value)):
        expected = simulate(with_values(base, {key: own}), tolerance=1e-11, backend="reduced").restitution
        assert columns["restitution_hand"][i] == pytest.approx(expected.hand, rel=1e-7, abs=1e-9)
        assert columns["first_touch_s"][i] == pytest.approx(expected.first_touch, rel=1e-9)


def test_a_wrist_mass_that_the_hand_feels_is_not_interpolated() -> None:
    scene = '[scene]\nrobot = "chaser_pa10_wrist"\njoints = "free"\n'
    gridded = engine(scene + "[grid]\nwrist.mass = [0.5, 0.9, 2.0]")
    scattered = engine(scene + "[scatter]\nwrist.mass = { uniform = 0.3 }")
    assert (gridded.method, scattered.method) == (EXACT, ONE_BY_ONE)
    masses = gridded.columns(0, 3)["hand_mass_kg"]
    for i, own in enumerate((0.5, 0.9, 2.0)):
        assert masses[i] == with_values(gridded.plan.scene, {"wrist.mass": own}).hand.mass
    assert np.unique(masses).size == 3
    drawn = scattered.columns(0, 1)
    own = with_values(scattered.plan.scene, {"wrist.mass": float(drawn["wrist.mass"][0])})
    expected = simulate(own, tolerance=1e-11).restitution.hand
    assert drawn["restitution_hand"][0] == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("extra", ['[scene.contact]\nlaw = "hertz"', "[scene.contact]\nmu = 0.1"])
def test_what_is_not_linear_is_integrated(extra: str) -> None:
    found = engine(f"[scene]\nrobot = 'pa10_wrist'\n{extra}\n[grid]\ntarget.mass = [9.0, 20.0]")
    assert found.method == INTEGRATED
    columns = found.columns(1, 2)
    expected = simulate(with_values(found.plan.scene, {"target.mass": 20.0})).restitution
    assert columns["restitution_hand"][0] == expected.hand
    assert columns["touches"][0] == expected.touches


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("format = 2", "unknown format"),
        ("not toml", "not TOML"),
        ("repeats = 0", "repeats: not a whole number"),
        ("repeats = true", "repeats"),
        ("rows_per_part = 1e3", "rows_per_part"),
        ("seed = -1", "seed"),
        ("speling = 1", "unknown key"),
        ("title = 3", "title: must be text"),
        ("scene = 3", "scene: must be a table"),
        ('scene = "nowhere.toml"', "no such scene"),
        ("[scene]\nrobot = 'pa11'", "pa11"),
        ("[scene.target]\nmas = 3", "unknown key"),
        ("grid = 3", "grid: must be a table"),
        ("[grid]\ntarget.mas = [1.0]", "did you mean 'target.mass'"),
        ("[grid]\ntarget.mass = []", "grid.target.mass"),
        ("[grid]\ntarget.mass = 9.0", "must be a list"),
        ("[grid]\ntarget.mass = [nan]", "not a finite number"),
        ("[grid]\ntarget.mass = [-9.0]", "reaches target.mass = -9"),
        ('[grid]\n"target.mass" = { from = 1.0, count = 3 }', "lacks to"),
        ('[grid]\n"target.mass" = { from = 0.0, to = 1.0, count = 3, log = true }', "must be positive"),
        ('[grid]\n"target.mass" = { from = 1.0, to = 2.0, count = 2.5 }', "whole number"),
        ("[grid]\n'target.mass' = [1.0]\ntarget.mass = [2.0]", "given twice"),
        ("[scatter]\ntarget.mass = 0.1", "must be a table"),
        ("[scatter]\ntarget.mass = { normal = 0.1, uniform = 0.1 }", "one kind"),
        ("[scatter]\ntarget.mass = { normal = -0.1 }", "must not be negative"),
        ("[scatter]\ntarget.mass = { normal = 0.3 }", "reaches target.mass = -1.8"),
        ("[scatter]\ntarget.yaw_inertia = { normal = 0.1 }", "not set"),
        ("[poses]\nlist_deg = [[0, 45]]", "7 joint positions"),
        ("[poses]\nlist = []", "list of poses"),
        ("[poses]\nspread_deg = 3.0", "needs a count"),
        ("[poses]\ncount = 2\nlist = [[0.0]]", "given twice"),
        ("repeats = 1_000_000_000_000\n[grid]\ntarget.mass = [1.0, 2.0]", "too many collisions"),
    ],
)
def test_a_mistake_is_answered_in_one_line(text: str, says: str) -> None:
    with pytest.raises(InputError, match=r"sweep: .") as caught:
        plan_from_text(text, HERE)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_page_s_example_is_a_sweep() -> None:
    page = (Path(__file__).resolve().parents[2] / "docs" / "sweep.md").read_text(encoding="utf-8")
    text = page.split("```toml\n")[1].split("```")[0]
    assert plan_from_text(text, HERE).total == 20 * 12 * 3 * 2 * 1000
    assert all(f"`{column}" in page or column.startswith("restitution_") for column in engine("").columns(0, 1))
