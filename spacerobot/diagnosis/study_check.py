"""A study read with all its files, and what it holds, as `spacerobot study check` says it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from spacerobot.diagnosis.selection.admission import left_aside, of_study, questions
from spacerobot.recordings import check
from spacerobot.recordings.ranges import Limits
from spacerobot.recordings.rig_robot import mended_links, study_robot
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError


def check_study(study: Study, *, report: Callable[[], object] = lambda: None) -> dict[str, Any]:
    """Read every file of a study, and say what is in it and what is odd about it.

    A trial that cannot be read is listed with its error; the others are still checked.

    Args:
        study: the study, a draft perhaps.
        report: told of every trial that was read.

    Returns:
        ready for JSON: title, trials, conditions, ranges of the channels, warnings, errors (why it cannot be
        diagnosed), draft (what it lacks).
    """
    limits, mended, fault = _robot(study)
    if study.draft:  # which is not diagnosed before its author has finished it
        found = check.check_study(study, limits, report=report)
    else:
        found = check.check_study(study, limits, questions(study), report)
        found["errors"] = list(dict.fromkeys([*map(str, of_study(study)), *found["errors"]]))
    found["warnings"] += mended
    found["not_predicted"] = list(left_aside(study))
    names = ", ".join([name for name in found["not_predicted"] if not name.startswith("aux.")][:12])
    if names:
        found["warnings"].append(f"recorded, but predicted by no model of this baseline, so left aside: {names}")
    if fault:
        found["errors"].append(f"robot: {fault}")
    return found


def _robot(study: Study) -> tuple[dict[str, Limits], list[str], str]:
    """What the study's robot says of its joints, what was mended in it, and why it cannot be read."""

    if study.baseline.robot is None:
        return {}, [], ""
    try:
        robot = study_robot(study)
    except InputError as error:
        return {}, [], str(error)
    rows = {r["name"]: r for r in robot.joint_rows()}
    found = {
        n: Limits(r["lower"], r["upper"], r["velocity_limit"], r["effort_limit"], slides=r["unit"] == "m")
        for n, r in rows.items()
    }
    return {**{name: Limits() for name in list(robot.model.names)[1:]}, **found}, mended_links(robot), ""
