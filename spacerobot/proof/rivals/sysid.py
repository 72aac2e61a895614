"""mujoco.sysid: the baseline's parameters identified from the tracks, and what its report says of the result.

Used as its own tests and docstrings show: a model specification, parameters with bounds and modifiers, one sequence a
trial, `optimize` with its default optimiser, `calculate_intervals`, the report's automated insights.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from typing import Any

import numpy as np

from spacerobot.proof.rivals.opinion import Opinion
from spacerobot.proof.rivals.tracks import Track, folds
from spacerobot.recordings.study import Study

STEP = 5e-4
"""Time step [s] of the model."""

ITERATIONS = 12

BOUNDS = {"stiffness": 2.0, "damping": 4.0, "mass": 1.5, "contact": 3.0}
"""Factor by which a parameter may differ from its believed value, either way."""


def sysid(study: Study, tracks: tuple[Track, ...]) -> Opinion:
    """Identify wrist spring, damper and mass and the contact stiffness; predict each condition from the others."""
    squares = {"target.x": 0.0, "wrist.x": 0.0}
    samples = 0
    for seen, unseen in folds(tracks):
        parameters, _ = _identified(study, seen)
        for track in unseen:
            target, wrist = _predicted(study, parameters, track)
            squares["target.x"] += float(np.sum((target - track.target) ** 2))
            squares["wrist.x"] += float(np.sum((wrist - track.wrist) ** 2))
            samples += track.time.size
    parameters, says = _identified(study, tracks)
    rms = {name: float(np.sqrt(s / samples)) for name, s in squares.items()}
    return Opinion(rms, says, "No Issues Detected" not in says)


def _spec(study: Study, mass: float) -> Any:
    import mujoco

    believed = _believed(study)
    text = f"""
<mujoco><option timestep="{STEP}" integrator="implicitfast" gravity="0 0 0"/>
<worldbody>
 <body name="wrist"><inertial pos="0 0 0" mass="{believed["mass"]}" diaginertia="1e-3 1e-3 1e-3"/>
  <joint name="wrist" type="slide" axis="1 0 0" stiffness="{believed["stiffness"]}" damping="{believed["damping"]}"/>
  <geom name="tip" type="sphere" size="0.05" pos="0.05 0 0" condim="1"/></body>
 <body name="target"><inertial pos="0 0 0" mass="{mass}" diaginertia="1e-1 1e-1 1e-1"/>
  <joint name="target" type="slide" axis="1 0 0"/>
  <geom name="face" type="sphere" size="0.05" pos="-0.05 0 0" condim="1"/></body>
</worldbody>
<actuator><motor name="none" joint="target" gear="0"/></actuator>
<sensor><jointpos name="target" joint="target"/><jointpos name="wrist" joint="wrist"/></sensor></mujoco>"""
    spec = mujoco.MjSpec.from_string(text)
    _contact(spec, believed["contact"])
    return spec


def _contact(spec: Any, stiffness: float) -> None:
    """MuJoCo's contact spring: its reference acceleration is a force over the effective mass of the two bodies."""
    share = 1.0 / spec.body("wrist").mass + 1.0 / spec.body("target").mass
    for name in ("tip", "face"):
        geom = spec.geom(name)
        geom.solref = [-stiffness * share, -60.0 * share]
        geom.solimp = [0.99, 0.99, 1e-3, 0.5, 2.0]


def _believed(study: Study) -> dict[str, float]:
    v = study.values()
    return {
        "stiffness": v["wrist.stiffness"],
        "damping": v["wrist.damping"] + v.get("wrist.equivalent_damping", 0.0),
        "mass": v["wrist.mass"],
        "contact": float(v.get("contact.stiffness", 5e4)),
    }


def _parameters(study: Study) -> Any:
    """Parameters as shares of their believed values: its intervals take those of unlike sizes for degenerate."""
    from mujoco import sysid as tool

    believed = _believed(study)
    found = tool.ParameterDict()

    def add(name: str, put: Callable[[Any, float], None]) -> None:
        width = BOUNDS[name]

        def modifier(spec: Any, p: Any) -> None:
            put(spec, believed[name] * float(p.value[0]))

        found.add(tool.Parameter(name, nominal=1.0, min_value=1.0 / width, max_value=width, modifier=modifier))

    def stiffness(spec: Any, value: float) -> None:
        spec.joint("wrist").stiffness = [value, 0.0, 0.0]

    def damping(spec: Any, value: float) -> None:
        spec.joint("wrist").damping = [value, 0.0, 0.0]

    def mass(spec: Any, value: float) -> None:
        spec.body("wrist").mass = value

    add("stiffness", stiffness)
    add("damping", damping)
    add("mass", mass)
    add("contact", _contact)
    return found


def _sequence(study: Study, track: Track) -> Any:
    from mujoco import sysid as tool

    spec = _spec(study, track.mass)
    model = spec.compile()
    order = {model.joint(i).name: i for i in range(model.njnt)}
    qpos, qvel = np.zeros(2), np.zeros(2)
    qpos[order["target"]], qvel[order["target"]] = track.start
    start = tool.create_initial_state(model, qpos, qvel)
    ticks = np.arange(0.0, track.time[-1], STEP)
    control = tool.TimeSeries(ticks, np.zeros((ticks.size, 1)))
    sensors = tool.TimeSeries.from_names(track.time, np.column_stack([track.target, track.wrist]), model)
    return tool.ModelSequences(track.id, spec, track.id, start, control, sensors)


def _identified(study: Study, tracks: tuple[Track, ...]) -> tuple[Any, str]:
    from mujoco import sysid as tool
    from mujoco.sysid.report.sections.insights import AutomatedInsights

    parameters = _parameters(study)
    residual = tool.build_residual_fn(models_sequences=[_sequence(study, t) for t in tracks], n_threads=1)
    with contextlib.redirect_stdout(io.StringIO()):  # it tells of every iteration
        best, result = tool.optimize(
            initial_params=parameters, residual_fn=residual, verbose=False, max_iters=ITERATIONS, x_scale="jac"
        )
    residuals, _, _ = residual(best.as_vector(), best)
    _, widths = tool.calculate_intervals([np.ravel(r) for r in residuals], result.jac)
    believed = _believed(study)
    values = ", ".join(
        f"{name} {believed[name] * share:.5g} +- {believed[name] * float(width):.2g}"
        for name, share, width in zip(best.get_non_frozen_parameter_names(), best.as_vector(), widths, strict=True)
    )
    said = "; ".join(i["title"] for i in AutomatedInsights("insights", best).get_context()["insights"])
    return best, f"{values}. Report: {said}"


def _predicted(study: Study, parameters: Any, track: Track) -> tuple[np.ndarray, np.ndarray]:
    from mujoco import sysid as tool

    sequence = _sequence(study, track)
    residual = tool.build_residual_fn(models_sequences=[sequence], n_threads=1, return_pred_all=True)
    _, predicted, _ = residual(parameters.as_vector(), parameters)
    series = predicted[0][0]
    times = np.asarray(series.times)
    columns = {name: at[1][0] for name, at in series.signal_mapping.items()}
    target, wrist = (np.interp(track.time, times, series.data[:, columns[n]]) for n in ("target", "wrist"))
    return target, wrist
