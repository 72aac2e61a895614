"""All pieces at once show what each shows alone; what hangs on another moment than its own is no such thing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from helpers_models import ARM, arm_log

from spacerobot.diagnosis.machines import joined_pieces
from spacerobot.diagnosis.machines.joined_pieces import instant, join
from spacerobot.diagnosis.machines.joint_torques import InverseDynamics
from spacerobot.diagnosis.terms.hypothesis import Site, hypothesis
from spacerobot.model.library import load

JOINTS = ("shoulder", "elbow")
NOTHING = np.zeros(0)


def machine() -> InverseDynamics:
    """An elbow whose masses and zeros are doubted, logged at two rates."""
    robot = load(ARM)
    slow, fast = (arm_log(robot, n, {"elbow": (0.5, 0.2, 0.1)}, seconds=8.0) for n in range(2))
    thin = {c: x[::2] for c, x in slow.value.items()}
    slow = replace(slow, time=slow.time[::2], step=2.0 * slow.step, value=thin, good=slow.good[::2])
    return InverseDynamics(
        robot,
        (0.0, 0.0, -9.81),
        {"slow": (slow, "a", {}), "fast": (fast, "b", {})},
        JOINTS,
        compared=["elbow"],
        sigma={"link.fore.mass": 0.1},
        absolute={"joint.elbow.zero": 0.01},
    )


MACHINE = machine()


def shown(one: InverseDynamics, site: Site) -> np.ndarray:
    """What all its pieces show with an effect at its start, and every value a little off."""
    made = hypothesis(one.believed, [site])
    z = np.clip(made.start() + 0.1, *made.bounds())
    every = [one.predict(one.trial_mechanism(made, z, t), t, NOTHING).blocks[0].ravel() for t in one.trials]
    return np.concatenate(every)


@pytest.mark.parametrize("site", MACHINE.sites(), ids=lambda s: "@".join(s.label))
def test_all_pieces_at_once_show_what_each_shows_alone(site: Site, monkeypatch: pytest.MonkeyPatch) -> None:
    together = shown(machine(), site)
    monkeypatch.setattr(joined_pieces, "instant", lambda mechanism: False)
    assert np.abs(together - shown(machine(), site)).max() <= 1e-12 * np.abs(together).max()


@pytest.mark.parametrize("name", ["maxwell", "low_pass", "time_offset"])
def test_what_remembers_would_be_seen(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Taken for an instant's own, a law with a memory goes on from one piece into the next, and a delay is none."""
    site = next(s for s in MACHINE.sites() if s.effect.name == name)
    made = hypothesis(MACHINE.believed, [site])
    assert not instant(MACHINE.trial_mechanism(made, made.start(), MACHINE.trials[0]))
    alone = shown(machine(), site)
    monkeypatch.setattr(joined_pieces, "instant", lambda mechanism: True)
    assert np.abs(alone - shown(machine(), site)).max() > 1e-6 * np.abs(alone).max()


def test_pieces_of_two_rates_are_two_rows() -> None:
    rows = join({t.id: (MACHINE.measured(t), MACHINE.bump(t)) for t in MACHINE.trials})
    assert sorted(sorted({n.split("@")[0] for n in row.sizes}) for row in rows) == [["fast"], ["slow"]]
    assert {n for row in rows for n in row.sizes} == {t.id for t in MACHINE.trials}
