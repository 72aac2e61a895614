"""A first study file from a folder of recordings: the kind of rig, its channels and trials, and what is left to say.

Whatever is written here, `study check` reads: the draft is read back, and what it would refuse is left out.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from spacerobot.recordings.drafting.angles import in_degrees
from spacerobot.recordings.drafting.behaviour import by_behaviour, with_slider, with_target
from spacerobot.recordings.drafting.beneath import trials_beneath
from spacerobot.recordings.drafting.cells import trials_in
from spacerobot.recordings.drafting.column_lists import column_lists, with_lists
from spacerobot.recordings.drafting.columns import Reading, joints_by_place, readings
from spacerobot.recordings.drafting.events import event_lines
from spacerobot.recordings.drafting.files import Found, recordings_in, robots_in
from spacerobot.recordings.drafting.gearing import gearing
from spacerobot.recordings.drafting.groups import Group, Trial, groups_of, trials_of
from spacerobot.recordings.drafting.heads import AXIS, head
from spacerobot.recordings.drafting.hints import loose
from spacerobot.recordings.drafting.lines import Line, comment, toml
from spacerobot.recordings.drafting.machines import AXIS_URDF, as_platform, draft_machine, kind_of
from spacerobot.recordings.drafting.message_names import with_message_names
from spacerobot.recordings.drafting.names import ENDINGS
from spacerobot.recordings.drafting.own_rates import by_rate
from spacerobot.recordings.drafting.pendulum import hang, pendulum_urdf, swing_of
from spacerobot.recordings.drafting.remarks import (
    ask_what_counts,
    ask_what_no_name_says,
    ask_what_pushes,
    say_who_names,
    second,
    settle_by_all,
    unrecognised,
)
from spacerobot.recordings.drafting.rigs import RIGS
from spacerobot.recordings.drafting.robots import hangs, joints_of
from spacerobot.recordings.drafting.run_list import list_of_runs
from spacerobot.recordings.drafting.several_hits import apart
from spacerobot.recordings.drafting.time_files import with_times
from spacerobot.recordings.drafting.unnamed import by_each_other
from spacerobot.recordings.drafting.wrist import Drafted, draft_wrist, is_wrist
from spacerobot.recordings.guess import UNTIMED, time_unit, unsaid_unit
from spacerobot.recordings.recording import load_trial
from spacerobot.recordings.study import load_study
from spacerobot.recordings.table import Column
from spacerobot.recordings.units import UNITS
from spacerobot.support.errors import InputError, NotFoundError

_MOST_REMARKS = 40

_MOST_ROUNDS = 60
"""Times that a draft is read back; each settles one refusal of every trial."""


@dataclass
class Draft:
    """A study in the making.

    Attributes:
        title: of the study.
        kind: "wrist", "arm", "platform", "body", "axis", "pendulum" or "" where nothing was recognised.
        robot: as a study names it, None where nothing is known of it.
        joints: of the robot, from base to tip.
        groups: stream -> its files.
        lines: stream -> its channels.
        settings: stream -> its other keys.
        left: stream -> columns that are no channel.
        trials: which files belong together.
        remarks: what was left out, and why.
        files: further files that the study needs, name -> text.
        gears: the lines of `[gears]`, none where joints are logged.
        listed: trial -> mass of its target, as the lab's own list of runs has it [kg].
        list_file: that list.
    """

    title: str
    kind: str
    robot: str | None
    joints: tuple[str, ...]
    groups: dict[str, Group]
    lines: dict[str, list[Line]]
    settings: dict[str, list[str]]
    left: dict[str, list[str]]
    trials: list[Trial]
    remarks: list[str]
    files: dict[str, str] = field(default_factory=dict)
    gears: list[str] = field(default_factory=list)
    listed: dict[str, float] = field(default_factory=dict)
    list_file: str = ""

    def text(self) -> str:
        """The study.toml."""
        parts = [head(self.title, self.kind, self.robot, self.joints, [self._mass(t)[0] for t in self.trials])]
        parts += ["\n".join(self.gears) + "\n"] if self.gears else []
        used = {name for trial in self.trials for name in trial.files}
        parts += [self._stream(name) for name in self.lines if name in used]
        parts += [self._trial(t) for t in self.trials if any(n in self.lines for n in t.files)]
        parts += ["".join(f"# not read: {comment(r)}\n" for r in self.remarks[:_MOST_REMARKS])]
        return "\n".join(p for p in parts if p)

    def _stream(self, name: str) -> str:
        lines = [f"[streams.{name}]", *self.settings[name], f"[streams.{name}.channels]"]
        lines += [line.text() for line in self.lines[name]]
        if self.left[name]:
            lines.append(f"# left out: {comment(', '.join(self.left[name]))}")
        return "\n".join(lines) + "\n"

    def _mass(self, trial: Trial) -> tuple[float | None, str]:
        """The mass of a trial's target or body, kg, and who says so; None where nobody does, or two masses are said."""
        if trial.id in self.listed:
            return self.listed[trial.id], self.list_file
        said = [(v * UNITS[unit].factor, text, f) for f in trial.files.values() for text, v, unit in f.named.values]
        if len({mass for mass, _, _ in said}) != 1:
            return None, ""
        mass, text, file = said[0]
        return mass, "the file's name" if text in file.relative.replace(",", ".") else f"the file: {text}"

    def _trial(self, trial: Trial) -> str:
        asked = f"   # ? {comment(trial.question)}" if trial.question else ""
        lines = ["[[trials]]", f"id = {toml(trial.id)}{asked}"]
        if trial.window is not None:
            lines.append(f"window = [{trial.window[0]:.6g}, {trial.window[1]:.6g}]   # s, as recorded")
        mass, source = self._mass(trial)
        owner = "body" if self.kind == "body" else "target"
        if mass is not None:
            lines.append(f"{owner}.mass = {mass:g}   # from {source}")
        elif self.kind == "wrist":
            lines.append("# target.mass =             # kg, if it is not the same in all trials")
        lines += [f"{name} = {_source(file)}" for name, file in trial.files.items() if name in self.lines]
        return "\n".join(lines) + "\n"


def draft_study(folder: str | Path, robot: str | None = None, *, rig: str = "", files: str = "*") -> str:
    """The text of a first study.toml for the recordings in `folder`, as `spacerobot study new` writes it.

    Args:
        folder: with the recordings, and perhaps a URDF.
        robot: name of the arm that was logged; the URDF among the files if None.
        rig: one of RIGS, "" to find out.
        files: pattern of the recordings' names; others are not read.

    Raises:
        InputError: the folder holds no recordings.
        NotFoundError: no such kind of rig.
    """
    return draft(Path(folder), robot, rig=rig, pattern=files).text()


def draft(folder: Path, robot: str | None = None, *, rig: str = "", pattern: str = "*") -> Draft:
    """A first study for the recordings in `folder`.

    Args:
        folder: of the recordings.
        robot: a bundled robot or one of example-robot-data; None for the URDF beside the files, if there is one.
        rig: one of RIGS, "" to find out.
        pattern: of the names of files, or of paths relative to the folder, that are read.

    Raises:
        InputError: no folder, no file in it that can be read, or no such robot.
        NotFoundError: no such kind of rig.
    """
    if rig and rig not in RIGS:
        raise NotFoundError("kind of rig", rig, RIGS)
    files, refused = recordings_in(folder, pattern)
    if not files:
        listed = "; ".join(refused[:5]) or "it holds none of " + ", ".join(ENDINGS)
        raise InputError("the folder holds no recording that can be read", given=str(folder), valid=listed)
    files = list(map(with_message_names, with_lists(files, column_lists(folder))))
    runs = list_of_runs(folder, files)
    every = [t for f in files if runs is None or f.label != runs.file for t in trials_in(f)]
    every = [trial for f in every for trial in trials_beneath(f)]
    files = with_times([part for file in every for part in by_rate(file)])
    robot, joints = joints_of(robots_in(folder), folder, [f.relative for f in files], robot)
    groups = groups_of(files)
    placed = joints_by_place({g.name: g.leanest for g in groups})
    seen = {g.name: readings(g.leanest, joints or placed.get(g.name, ())) for g in groups}
    trials = trials_of(groups)
    kind = rig or ("wrist" if is_wrist(seen) else kind_of(seen))
    named = seen
    if not joints and (kind in ("", "axis", "body") if not rig else rig == "wrist"):
        plane = kind == "body" and not _no_plane(seen)
        seen = by_behaviour(seen, trials, slider=plane) or seen
        kind = "wrist" if is_wrist(seen) else kind
    events = {
        g.name: own for g in groups if kind in ("", "body", "axis") and (own := event_lines(seen[g.name], g.leanest))
    }
    if events:
        kind = "body"
    elif kind == "" or rig:
        seen = by_each_other(seen, trials, rig)
        kind = rig or kind_of(seen)
    if kind == "platform":
        seen, named = as_platform(seen), as_platform(named)
    if kind == "wrist" and not any(r.thing == "wrist" for found in seen.values() for r in found):
        seen = with_slider(seen, trials)
    if kind == "wrist" and not any(r.thing == "target" for found in seen.values() for r in found):
        seen = with_target(seen, trials)
    if kind == "wrist":
        trials = apart(seen, trials)
    alone = kind in ("axis", "pendulum")
    beside = robot is not None and (folder / robot).is_file()
    its_own = robot if alone and beside and len(joints) == 1 else None  # a URDF of one joint is what moves
    rest = hangs(folder / its_own, joints[0]) if its_own is not None else 0.0
    swinging = swing_of(seen, trials, named, turns=its_own is not None) if alone and rest is not None else None
    kind = "axis" if alone else kind
    representative = {g.name: g.leanest for g in groups}
    if kind == "wrist":
        drafted = draft_wrist(seen, trials) if is_wrist(seen) else Drafted({})
    else:
        joint = joints[0] if its_own else AXIS
        columns = draft_machine(kind, seen, representative, driven=swinging is None, joint=joint)
        drafted = Drafted(events or columns)
    if swinging is not None:
        kind = "pendulum"
        place = next(x for x in drafted.lines[swinging[0]] if x.channel.endswith(".position"))
        hang(place, swinging[1], rest or 0.0)
    ask_what_no_name_says(drafted, named, "does in a hit" if kind == "wrist" else "does")
    told = [g for g in groups if drafted.lines.get(g.name)] or groups
    if len(told) < len(groups):  # files of which nothing was recognised would only part what belongs together
        trials = trials_of(told)
        trials = apart(seen, trials) if kind == "wrist" else trials
        refused += [second(g, kind, seen[g.name]) or unrecognised(g) for g in groups if g not in told]
    taken: set[str] = set()
    lines = {g.name: drafted.lines.get(g.name) or loose(seen[g.name], g.leanest, kind, taken) for g in told}
    refused += [unrecognised(g) for g in told if not lines[g.name]]
    say_who_names(lines, representative)
    ask_what_counts(lines)
    settle_by_all(lines, told)
    left = {g.name: _left(seen[g.name], lines[g.name]) for g in told}
    if kind in ("body", "platform"):
        ask_what_pushes(lines, left, "base" if kind == "platform" else "body")
    made = Draft(
        title=folder.resolve().name or "study",
        kind=kind,
        robot=robot if kind in ("arm", "platform") else its_own,
        joints=joints,
        groups={g.name: g for g in told},
        lines={name: found for name, found in lines.items() if found},
        settings={g.name: _settings(g, drafted.own_clock.get(g.name), events=g.name in events) for g in told},
        left=left,
        trials=trials,
        remarks=refused,
    )
    if runs is not None and kind in ("wrist", "body"):
        made.listed, made.list_file = runs.masses(trials), runs.file
    if kind in ("arm", "platform"):
        made.gears = gearing(made.lines, representative)
    in_degrees(made.lines, representative)
    if swinging is not None and its_own is None:
        made.files["pendulum.urdf"] = pendulum_urdf(swinging[1])
    if kind == "axis" and its_own is None:
        told_of = [line.reading for found in lines.values() for line in found]
        turns = any(c.unit in ("rad", "deg") or c.axis == "yaw" for c in told_of)
        shape = ("revolute", "0 0 1") if turns else ("prismatic", "1 0 0")
        made.files["axis.urdf"] = AXIS_URDF.format(kind=shape[0], direction=shape[1])
    return _readable(made, folder)


def _source(file: Found) -> str:
    said = {"variable": file.variable, "time_file": file.times[0] if file.times else None}
    further = "".join(f", {key} = {toml(value)}" for key, value in said.items() if value is not None)
    further += f", rows = [{file.span[0]}, {file.span[1]}]" if file.span is not None else ""
    return f"{{ file = {toml(file.relative)}{further} }}" if further else toml(file.relative)


def _no_plane(seen: Mapping[str, Sequence[Reading]]) -> bool:
    """Whether all that is called a position is one number, or a target's: no body's place in the plane."""
    every = [r for found in seen.values() for r in found if r.quantity == "position" and not r.command]
    return len(every) == 1 or all(r.thing == "target" for r in every)


def _left(found: Sequence[Reading], lines: Sequence[Line]) -> list[str]:
    used = {line.reading.column for line in lines} | {c for line in lines for c in line.plus}
    left = [r.column for r in found if r.column not in used]
    return [*left[:24], *([f"and {len(left) - 24} more"] if len(left) > 24 else [])]


def _settings(group: Group, own_clock: str | None, *, events: bool) -> list[str]:
    """Format, times, clock and missing readings of a stream."""
    file = group.leanest
    lines = [] if file.format in ("csv", "text") else [f"format = {toml(file.format)}"]
    clock = file.clock
    if events:
        lines.append('kind = "events"')
    elif file.times is not None:
        lines.append(f"time = {toml(file.times[1])}   # of the file that each trial names")
    elif clock is None and file.rate is not None:
        beside = "by the clock beside it" if file.variable else "as it says above its table"
        lines.append(f"rate = {file.rate:g}   # Hz, {beside}")
    elif clock is None:
        lines.append(f"rate = {UNTIMED}   # ? Hz: no column looked like a clock")
    else:
        column = file.called.columns[clock]
        lines.append(f"time = {toml(file.table.names()[clock])}{_rate(column)}")
        if unsaid := unsaid_unit(column):
            asked = f"its steps would be {_step(column):g} s"
            lines.append(f"time_unit = {toml(unsaid)}   # ? no unit is stated, and in seconds {asked}")
        elif time_unit(column) != "s":
            lines.append(f"time_unit = {toml(time_unit(column))}")
    if missing := sorted({value for f in group.files for value in f.missing}):
        lines.append(f"missing = {missing}   # no readings: given again and again, far from all others")
    if own_clock:
        lines.append(f'clock = "own"   # {comment(own_clock)}')
    return lines


def _rate(column: Column) -> str:
    step = _step(column)
    rate = 1.0 / (step * UNITS[unsaid_unit(column) or time_unit(column)].factor) if step > 0 else math.nan
    return f"   # about {rate:.4g} Hz" if math.isfinite(rate) else ""


def _step(column: Column) -> float:
    """Median step of a clock, in its own unit."""
    return float(np.median(np.diff(column.values[np.isfinite(column.values)])))


def _readable(made: Draft, folder: Path) -> Draft:
    """`made` without what its own check would refuse; each refusal becomes a remark.

    Raises:
        InputError: nothing is left.
    """
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "study.toml"
        for _ in range(_MOST_ROUNDS):
            made.trials = [t for t in made.trials if any(n in made.lines for n in t.files)]
            if not made.trials:
                break
            path.write_text(made.text(), encoding="utf-8")
            study = load_study(path, data=folder)
            faults = []
            seen: dict[str, list[float]] = {}
            for trial in made.trials:
                try:
                    recording = load_trial(study.streams, study.root, study.trial(trial.id))
                except InputError as error:
                    faults.append((trial, error))
                    continue
                for series in recording.values():
                    good = series.good()[1]
                    seen.setdefault(series.name, []).extend([float(good.min()), float(good.max())])
            if not faults and not _without_the_still(made, {n for n, own in seen.items() if min(own) == max(own)}):
                return made
            for trial, fault in faults:
                _mend(made, trial, fault, folder)
    raise InputError(
        "the folder holds no recording that can be read", given=str(folder), valid="; ".join(made.remarks[-5:])
    )


def _without_the_still(made: Draft, still: set[str]) -> bool:
    """Whether channels were left out that read the same throughout every trial: nothing can be weighed by them.

    A wrist rig's are weighed together.
    """
    if made.kind == "wrist":
        return False
    dropped = False
    for stream, lines in list(made.lines.items()):
        dead = [x for x in lines if x.use == "output" and x.channel in still and not x.channel.startswith("aux.")]
        if not dead or len(dead) == len(lines):
            continue
        made.lines[stream] = [x for x in lines if x not in dead]
        names = ", ".join(x.reading.column for x in dead)
        made.remarks.append(f"{stream}: {names}: the same reading throughout every trial")
        dropped = True
    return dropped


def _mend(made: Draft, trial: Trial, error: InputError, folder: Path) -> None:
    """Settle one refusal: by a setting of the stream where there is one, else without the channel or the file."""
    where = (error.where or "").replace(str(folder.resolve()) + "/", "").replace(str(folder) + "/", "")
    owner = next((n for n, f in trial.files.items() if n in made.lines and where.startswith(f.relative)), None)
    name = owner or next(n for n in trial.files if n in made.lines)
    settings = made.settings[name]
    if "stands still" in error.what and 'repeated = "first"' not in settings:
        settings.append('repeated = "first"')
        return
    if "backwards" in error.what and "sort = true" not in settings:
        settings.append("sort = true")
        return
    channel = next((line for found in made.lines.values() for line in found if line.channel in error.what), None)
    stream = next((n for n, found in made.lines.items() if channel in found), name)
    if channel is not None and len(made.lines[stream]) > 1:
        made.lines[stream].remove(channel)
        made.remarks.append(f"column {channel.reading.column} of {stream}: {error}")
        return
    made.remarks.append(str(error).replace(str(folder.resolve()), "."))
    del trial.files[name]
