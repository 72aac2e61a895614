"""Which models a study asks for: decided by its baseline and by what was logged, never by its name."""

from __future__ import annotations

from spacerobot.diagnosis.models.grid import even_grid
from spacerobot.diagnosis.models.inverse_dynamics import InverseDynamics
from spacerobot.diagnosis.models.links import robot_of
from spacerobot.diagnosis.models.model import Model
from spacerobot.recordings.study import Study
from spacerobot.recordings.trial import Trial


def models_for(study: Study) -> tuple[Model, ...]:
    """One model for each part of the study that can be told apart from the others: a joint, a body, a sensor.

    Raises:
        InputError: nothing that was recorded can be compared with the baseline.
    """
    return _joints(study)


def _joints(study: Study) -> tuple[Model, ...]:
    """A balance for each joint whose position and torque were logged."""
    groups: dict[tuple[str, ...], list[Trial]] = {}
    for trial in study.trials:
        recording = study.recording(trial)
        names = [c.split(".")[1] for c in recording if c.startswith("joint.") and c.endswith(".torque")]
        both = tuple(n for n in names if f"joint.{n}.position" in recording)
        if both:
            groups.setdefault(both, []).append(trial)
    found: list[Model] = []
    for joints, trials in groups.items():
        robot = robot_of(study)
        logged = ("position", "torque", "velocity")
        fully = all(f"joint.{j}.velocity" in study.recording(t) for j in joints for t in trials)
        channels = [f"joint.{j}.{what}" for j in joints for what in logged[: 3 if fully else 2]]
        grids = {t.id: (even_grid(study.recording(t), channels), study.condition(t), dict(t.overrides)) for t in trials}
        stream = study.recording(trials[0])[f"joint.{joints[0]}.torque"].stream
        values = {n: v for n, v in study.values().items() if n.startswith("joint.")}
        for joint in joints:
            unknown = [n for n in sorted(study.baseline.unknown) if n.startswith(f"joint.{joint}.")]
            found.append(
                InverseDynamics(
                    robot,
                    study.baseline.gravity,
                    grids,
                    joints,
                    compared=[joint],
                    values=values,
                    unknown=unknown,
                    sensor=stream,
                )
            )
    return tuple(found)
