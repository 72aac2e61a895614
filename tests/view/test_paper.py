"""The paper command and what it shows: computed once through the command, then judged."""

from __future__ import annotations

import csv
import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from lxml import html

from spacerobot.cli.main import main
from spacerobot.theory import assumptions, coulomb_slider, table1
from spacerobot.theory.exact import solve
from spacerobot.view import plotting
from spacerobot.view.paper import limits, sweeps, trials
from spacerobot.view.paper.figures import FIGURES

PALETTE = {c.lower() for c in (*plotting.SERIES, plotting.GREY, plotting.YELLOW)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("paper") / "out"
    assert main(["paper", "--out", str(out), "--seed", "4"]) == 0
    return out


@pytest.fixture(scope="module")
def answer(folder: Path) -> dict:
    def refuse(token: str) -> float:
        raise AssertionError(f"{token} is not RFC 8259")

    return json.loads((folder / "paper.json").read_text(), parse_constant=refuse)


def test_writes_page_table_data_and_a_picture_of_each_figure(folder: Path) -> None:
    names = {p.name for p in folder.iterdir() if not p.name.startswith(".")}
    assert names == {"paper.html", "paper.json", "table1.csv", "run.json", *(f"{n}.png" for n in FIGURES)}
    for name in FIGURES:
        content = (folder / f"{name}.png").read_bytes()
        assert content.startswith(b"\x89PNG")
        assert len(content) > 20_000, "an empty drawing is smaller"


def test_table_1_as_csv(folder: Path) -> None:
    rows = list(csv.DictReader((folder / "table1.csv").open()))
    assert [(float(r["k_w [N/m]"]), float(r["c_w [N s/m]"])) for r in rows] == [
        (530, 1.4),
        (1020, 2.1),
        (3600, 2.8),
        (5100, 2.7),
    ]
    assert {float(r["m_w [kg]"]) for r in rows} == {0.7}


def test_the_page_needs_no_other_file_and_speaks_plainly(folder: Path) -> None:
    page = html.fromstring((folder / "paper.html").read_text(encoding="utf-8"))
    sources = page.xpath("//img/@src")
    assert len(sources) == len(FIGURES)
    assert all(s.startswith("data:image/svg+xml;base64,") for s in sources)
    assert not page.xpath("//script | //link | //*[@href]")
    assert all(image.get("alt") for image in page.xpath("//img"))
    text = " ".join(page.text_content().split())
    assert "Eq. 5 as printed is not the natural frequency of Eqs. 2 to 4." in text
    assert "Before the end of Eq. 14 the force pulls." in text
    assert "inf" not in text.split("Assumptions 1 to 8")[1].split("Equations 1 to 19")[0].replace("infinity", "")


def test_json_holds_five_trials_for_each_of_twelve_conditions(answer: dict) -> None:
    assert len(answer["conditions"]) == 12
    assert len(answer["trials"]) == 60
    assert all(c["trials"] == 5 for c in answer["conditions"])
    assert [e["number"] for e in answer["equations"]] == list(range(1, 20))
    assert [len(a["findings"]) for a in answer["assumptions"]] == [12] * 8
    soft = [t["speed"] for t in answer["trials"] if t["stiffness"] < 2000]
    assert np.mean(soft) == pytest.approx(0.10, abs=0.008)
    assert np.mean([t["speed"] for t in answer["trials"]]) == pytest.approx(0.07, abs=0.006)
    assert np.std(soft) > 0.003, "hand-set speeds scatter"


def test_both_readings_of_the_damping_at_530_and_9_7(answer: dict) -> None:
    first = answer["conditions"][0]
    assert first["theory_restitution_wrist"] == pytest.approx(0.97, abs=0.005)
    assert first["theory_restitution"] == pytest.approx(0.74, abs=0.005)


def test_dots_lie_by_the_exact_curves_and_the_simplified_ones_lie_above(answer: dict) -> None:
    """Friction stands for c_eq at one amplitude only: the lightest, softest condition is furthest off."""
    for condition in answer["conditions"]:
        curve = next(c for c in answer["curves"] if c["stiffness"] == condition["stiffness"])
        mass = condition["target_mass"] + 0.7
        e, tau = (np.interp(mass, curve["lumped_mass"], curve[key]) for key in ("e_exact", "time_exact"))
        assert condition["restitution"] == pytest.approx(e, abs=0.09)
        assert condition["contact_time"] == pytest.approx(tau, rel=0.02)
        assert condition["restitution"] < condition["theory_restitution"]
        assert (np.array(curve["e_exact"]) < curve["e_simplified"]).all()
        assert (np.array(curve["e_simplified"]) < curve["e_wrist"]).all()


def test_answers_of_eqs_5_and_14(answer: dict) -> None:
    five, fourteen = answer["equation_5"], answer["equation_14"]
    assert five["printed_low_branch_rad_s"] == 19.8
    assert five["exact_low_branch_rad_s"] == pytest.approx(7.37, abs=0.005)
    assert five["equations_9_and_10_rad_s"] == pytest.approx(7.39, abs=0.005)
    assert 0 < fourteen["force_zero_s"] < fourteen["end_s"]
    assert fourteen["adhesive_peak_N"] > 0


def test_a_finished_run_is_reused_and_another_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = (folder / "paper.html").stat().st_mtime_ns
    assert main(["paper", "--out", str(folder), "--seed", "4", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["seed"] == 4
    assert main(["paper", "--out", str(folder), "--seed", "5"]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert (folder / "paper.html").stat().st_mtime_ns == before


@pytest.mark.parametrize(
    "bad",
    [
        ["--seed", "x"],
        ["--seed", "-1"],
        ["--seed", "1.5"],
        ["--equivalent-damping", "0"],
        ["--equivalent-damping", "-3"],
        ["--equivalent-damping", "nan"],
        ["--equivalent-damping", "1e9"],
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(
    bad: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["paper", "--out", str(tmp_path / "o"), *bad]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert bad[0] in error
    assert not (tmp_path / "o").exists()


@pytest.mark.parametrize("friction", [0.0, 0.9])
def test_a_trial_measures_what_the_exact_motion_does(friction: float) -> None:
    spring = table1.SPRINGS[0]
    found = trials.trial(spring, 9.0, 0.1, friction, np.random.default_rng(1))
    system = dataclasses.replace(
        table1.three_masses(spring, 9.0, damping="wrist", hand_mass=float("inf")), guide_friction=friction
    )
    motion = solve(system, 0.1, duration=1.0)
    assert found.contact_time == pytest.approx(motion.contact_time, rel=1e-6)
    assert found.touches == len(motion.times_of("touch"))
    noise = 2 * trials.MOCAP_NOISE / trials.AVERAGED_OVER / 0.1  # of a mean velocity, relative
    assert found.restitution == pytest.approx(-float(motion.state(1.0)[5]) / 0.1, abs=5 * noise)
    assert found.restitution != -float(motion.state(1.0)[5]) / 0.1, "the recording is noisy"


def test_trials_repeat_with_their_seed_and_feel_the_friction() -> None:
    spring = table1.SPRINGS[1]
    one, two, other = (
        trials.trial(spring, 23.2, 0.1, 0.5, np.random.default_rng(seed)).restitution for seed in (1, 1, 2)
    )
    assert one == two != other
    assert trials.trial(spring, 23.2, 0.1, 1.0, np.random.default_rng(1)).restitution < one - 0.03


def test_sweeps_follow_their_closed_forms_within_table_1() -> None:
    for sweep, tolerance in zip(sweeps.sweeps(12.3), (0.002, 0.002, 0.002, 0.006), strict=True):
        inside = slice(None) if sweep.at is None else (sweep.x >= sweep.at[0]) & (sweep.x <= sweep.at[1])
        assert np.abs(sweep.found - sweep.expected)[inside].max() < tolerance
        cost = np.abs(sweep.found)
        assert cost.max() > 10 * tolerance, "the assumption does cost something once broken"


def test_hand_mass_to_infinity_at_first_order() -> None:
    check = limits.hand_mass_check()
    heavy = check.hand_mass >= 1e3
    for gap in (check.time_simplified, check.time_exact, 0.5 * (1 - check.reduced_mass / check.lumped_mass)):
        slope = np.polyfit(np.log(check.hand_mass[heavy]), np.log(gap[heavy]), 1)[0]
        assert slope == pytest.approx(-1, abs=0.01)


def test_a_servo_held_arm_tends_to_a_locked_one_at_first_order() -> None:
    check = limits.servo_check()
    gap = check.reduced_mass / check.lumped_mass - 1
    assert (check.mobility < 0).all(), "below its resonance the arm is a spring"
    stiff = check.stiffness >= 1e5
    assert np.polyfit(np.log(check.stiffness[stiff]), np.log(gap[stiff]), 1)[0] == pytest.approx(-1, abs=1e-3)
    np.testing.assert_allclose(gap[stiff], check.expected[stiff], rtol=2e-3)
    assert gap[-1] < 1e-6


def test_restitution_rises_with_speed_and_meets_the_constant_once() -> None:
    check = limits.speed_check(12.3)
    comes_back = check.coulomb > 0
    assert (np.diff(check.coulomb[comes_back]) > 0).all()
    assert np.count_nonzero(np.diff(np.sign(check.coulomb - check.constant))) == 1
    assert (check.coulomb[check.speed < check.smallest_speed] == 0).all()
    assert check.friction == pytest.approx(coulomb_slider.equivalent_friction(12.3, 0.1))


@pytest.mark.slow
def test_figures_keep_to_the_palette_and_label_their_axes(folder: Path) -> None:
    from spacerobot.view.paper.data import compute

    data = compute(4, 12.3)
    colours = set()
    for name, draw in FIGURES.items():
        figure = draw(data)
        for axes in figure.axes:
            shared = not axes.get_subplotspec().is_first_col() or not axes.get_subplotspec().is_last_row()
            assert shared or (axes.get_xlabel() and (axes.get_ylabel() or name == "assumption_costs")), name
            for line in axes.lines:
                colour = line.get_color()
                if isinstance(colour, str):
                    colours.add(colour.lower())
    assert colours <= PALETTE
    assert len(data.findings) * len(assumptions.ASSUMPTIONS) == 96
