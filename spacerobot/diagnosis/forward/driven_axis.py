"""One joint driven by a recorded force: a motor axis, or an electronic oscillator that stands for one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Self

from spacerobot.diagnosis.forward.base import channels_of
from spacerobot.diagnosis.forward.momentum_balance import balance
from spacerobot.diagnosis.forward.parts import Parts, as_believed
from spacerobot.diagnosis.machines import torque_log
from spacerobot.diagnosis.machines.axis import axis_model
from spacerobot.diagnosis.machines.links import robot_of
from spacerobot.diagnosis.machines.simulated import Simulated
from spacerobot.recordings.study import Study

LAWS = ("mass", "damping", "stiffness")


@dataclass(frozen=True, eq=False)
class DrivenAxis(Parts):
    """m a + c v + k x = recorded force, on one joint: its motion, also where a diagnosis compares torques."""

    kind = "one joint driven by its recorded force (reduced model)"
    source = "unknown to the study: from all trials"

    @classmethod
    def applies(cls, study: Study) -> bool:
        """Exactly one joint has a recorded drive, and its position is recorded."""
        return study.baseline.base == "fixed" and _driven(study) is not None

    @classmethod
    def of(cls, study: Study) -> Self:
        """The axis as believed; what is unknown from the recordings.

        Raises:
            InputError: the recordings do not determine what is unknown.
        """
        joint = _driven(study)
        assert joint is not None  # applies() has seen it
        model = axis_model(study, study.trials, joint, robot_of(study))
        return cls(study, (as_believed(model, _found(model, study, joint)),))


def _found(model: Simulated, study: Study, joint: str) -> dict[str, float]:
    """What is unknown of the axis, from the momentum balance of all trials: friction that is not in the baseline would
    bend a fit of its motion far more. Nothing where that is in the baseline, and a fit says it all.
    """
    names = [n.rpartition(".")[2] for n in model.believed.unknown]
    if not names or not set(names) <= set(LAWS) or model.base.get(f"joint.{joint}.friction"):
        return {}
    values, own = study.values(), {n.rpartition(".")[2]: v for n, v in model.base.items()}
    stated = {law: own[law] for law in LAWS if law in own}
    tracks = [study.recording(t) for t in study.trials]
    found = balance(tracks, joint, stated, names, partial(torque_log.torque, values, joint))
    return {f"joint.{joint}.{law}": value for law, value in found.items()}


def _driven(study: Study) -> str | None:
    """The one joint with a recorded drive and position; None where there is none, or several."""
    inputs, every = channels_of(study, "input"), channels_of(study)
    names = {c.split(".")[1] for c in inputs if c.startswith("joint.") and c.endswith(".torque")}
    recorded = {n for n in names if f"joint.{n}.position" in every}
    return recorded.pop() if len(recorded) == len(names) == 1 else None
