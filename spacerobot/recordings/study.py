"""A study: what a lab believes about its rig, and the trials it recorded."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from spacerobot.recordings.baseline import Baseline, read_baseline
from spacerobot.recordings.dataroot import data_root, inside
from spacerobot.recordings.document import Document, read_document
from spacerobot.recordings.gears import geared, read_gears
from spacerobot.recordings.recording import Recording, load_trial
from spacerobot.recordings.sensor_filter import SensorFilter
from spacerobot.recordings.stream import StreamSpec, read_stream
from spacerobot.recordings.trial import _GROUPS, _KEYS, Trial, index_file, read_trials
from spacerobot.recordings.values import kind
from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.formats import require_format
from spacerobot.support.resources import folder
from spacerobot.support.showing import html_table
from spacerobot.support.tables import data_frame

if TYPE_CHECKING:
    import pandas

FORMAT = 1
_TOP = ("format", "draft", "title", "data", "exact", "horizon", "baseline", "gears", "streams", "trials")


@dataclass(frozen=True)
class Study:
    """What a lab believes and what it recorded.

    Attributes:
        title: one line.
        path: the study file.
        root: folder that stream files are relative to.
        baseline: what the lab believes.
        streams: name -> how its files are read.
        trials: in the order of the study.
        draft: whether the study says that its author has not finished it (`draft = true`).
        draft_line: file and line that say so.
        indices: the lists of runs that trials were taken from.
        horizon: how long a simulation runs before it starts anew from the recording [s]; by the data if None.
    """

    title: str
    path: Path
    root: Path
    baseline: Baseline
    streams: Mapping[str, StreamSpec]
    trials: tuple[Trial, ...]
    draft: bool = False
    draft_line: str | None = None
    indices: tuple[Path, ...] = ()
    horizon: float | None = None
    _cache: dict[str, Recording] = field(default_factory=dict, repr=False, compare=False)

    def __repr__(self) -> str:
        draft = ", a draft" if self.draft else ""
        return f"Study({self.title!r}, {len(self.trials)} trials, {len(self.channels())} channels{draft})"

    def _repr_html_(self) -> str:
        sigma = self.baseline.sigma
        rows = [(name, value, kind(name).unit, sigma.get(name)) for name, value in self.baseline.values.items()]
        notes = [
            f"{len(self.trials)} trials in {len(self.conditions())} conditions; channels: {', '.join(self.channels())}",
            *(["A draft: its author has not finished it."] if self.draft else []),
        ]
        return html_table(self.title, rows, ("believed", "value", "unit", "relative sigma"), notes)

    def to_frame(self) -> pandas.DataFrame:
        """A row for each trial: its condition and every value that it states itself, SI, as a table of pandas.

        Raises:
            InputError: pandas is not installed.
        """
        own = dict.fromkeys(name for trial in self.trials for name in trial.overrides)
        columns: dict[str, list[object]] = {"condition": [self.condition(t) for t in self.trials]}
        columns |= {name: [self.value(name, t) for t in self.trials] for name in own}
        return data_frame(columns, index=[t.id for t in self.trials], name="trial")

    @property
    def sigma(self) -> Mapping[str, float]:
        """Dotted name -> relative standard deviation of the believed value (one true value a study)."""
        return self.baseline.sigma

    @property
    def absolute(self) -> Mapping[str, float]:
        """Dotted name -> standard deviation of a value that is believed to be zero, SI."""
        return self.baseline.absolute

    @property
    def scatter(self) -> Mapping[str, float]:
        """Dotted name -> relative standard deviation of its change between conditions."""
        return self.baseline.scatter

    def trial(self, trial: Trial | str) -> Trial:
        """The trial with this id.

        Raises:
            NotFoundError: no such trial.
        """
        if isinstance(trial, Trial):
            return trial
        for candidate in self.trials:
            if candidate.id == trial:
                return candidate
        raise NotFoundError("trial", trial, (t.id for t in self.trials), where=str(self.path))

    def values(self, trial: Trial | str | None = None) -> dict[str, float]:
        """All believed values by dotted name, SI, with the trial's overrides."""
        found = dict(self.baseline.values)
        if trial is not None:
            found.update(self.trial(trial).overrides)
        return found

    def value(self, name: str, trial: Trial | str | None = None) -> float | None:
        """The believed value called `name`, SI, with the trial's override; None where it is unknown."""
        return self.values(trial).get(name)

    def pose(self, trial: Trial | str | None = None) -> tuple[float, ...]:
        """Joint positions from base to tip, rad, with the trial's override."""
        own = None if trial is None else self.trial(trial).pose
        return self.baseline.pose if own is None else own

    def sigma_of(self, name: str) -> float | None:
        """Relative deviation of a believed value; that of equivalent_damping serves the wrist's damping."""
        if name in self.sigma:
            return self.sigma[name]
        return self.sigma.get("wrist.equivalent_damping") if name == "wrist.damping" else None

    def condition(self, trial: Trial | str) -> str:
        """What the trial shares with its like: its stated condition, else its target mass, else "all"."""
        trial = self.trial(trial)
        if trial.condition is not None:
            return trial.condition
        mass = self.value("target.mass", trial)
        return "all" if mass is None else f"target.mass={mass:g}"

    def conditions(self) -> dict[str, tuple[Trial, ...]]:
        """Condition -> its trials, in order of appearance."""
        groups: dict[str, list[Trial]] = {}
        for trial in self.trials:
            groups.setdefault(self.condition(trial), []).append(trial)
        return {name: tuple(trials) for name, trials in groups.items()}

    def channels(self) -> tuple[str, ...]:
        """Every channel that any trial has, in order of the streams."""
        used = {name for trial in self.trials for name in trial.sources}
        return tuple(dict.fromkeys(c.name for s in self.streams.values() if s.name in used for c in s.channels))

    def recording(self, trial: Trial | str) -> Recording:
        """The trial's channels, read on first use and kept.

        Raises:
            InputError: a file cannot be read; with file, line and reason.
        """
        trial = self.trial(trial)
        if trial.id not in self._cache:
            self._cache[trial.id] = load_trial(self.streams, self.root, trial)
        return self._cache[trial.id]

    def recordings(self) -> dict[str, Recording]:
        """Trial id -> its channels, for all trials."""
        return {trial.id: self.recording(trial) for trial in self.trials}

    def file(self, relative: str, *, where: str | None = None) -> Path:
        """A stream file inside the data root.

        Raises:
            InputError: it is missing, or outside the root once links are resolved.
        """
        return inside(self.root, relative, where=where, folder=None)

    @property
    def robot_file(self) -> Path | None:
        """The URDF that lies beside the study, or else beside its recordings; None where the robot is named.

        Raises:
            InputError: the file is missing or outside these folders.
        """
        robot = self.baseline.robot
        if robot is None or not ("/" in robot or "\\" in robot or robot.lower().endswith((".urdf", ".xml", ".xacro"))):
            return None
        try:
            return inside(self.path.parent, robot, where=str(self.path))
        except InputError:
            if self.root == self.path.parent:
                raise
            return inside(self.root, robot, where=str(self.path))

    @property
    def robot_source(self) -> Path | str | None:
        """What to load the robot from: the study's own URDF, else the robot's name, None for a free body alone."""
        return self.robot_file or self.baseline.robot

    def filters(self) -> dict[str, SensorFilter]:
        """Channel -> the filter that its sensor is known to have."""
        return {c.name: c.filter for s in self.streams.values() for c in s.channels if c.filter is not None}

    def with_filter(self, channel: str, own: SensorFilter) -> Study:
        """The same study and recordings, the channel's sensor known to have this filter."""
        streams = {
            name: replace(s, channels=tuple(replace(c, filter=own) if c.name == channel else c for c in s.channels))
            for name, s in self.streams.items()
        }
        return replace(self, streams=streams)

    def unread(self) -> Study:
        """The same study without the recordings that were read already: what is sent to another process."""
        return replace(self, _cache={})

    @property
    def input_hash(self) -> str:
        """SHA-256 over the study file, its URDF, its lists of runs and every stream file: what results rest on."""
        digest = hashlib.sha256()
        for label, path in self._inputs():
            digest.update(f"\0{label}\0{path.stat().st_size}\0".encode())
            with path.open("rb") as stream:
                while block := stream.read(1 << 20):
                    digest.update(block)
        return digest.hexdigest()

    def _inputs(self) -> list[tuple[str, Path]]:
        found = {"study.toml": self.path}
        if self.robot_file is not None:
            found["robot"] = self.robot_file
        root = self.root.resolve()
        found.update({f"data/{p.relative_to(root)}": p for p in self.indices})
        for trial in self.trials:
            for source in trial.sources.values():
                for name in filter(None, (source.file, source.time_file)):
                    path = self.file(name, where=trial.where)
                    inner = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
                    found.update({f"data/{p.relative_to(root)}": p for p in inner})
        return sorted(found.items())


def load_study(path: str | Path, data: str | Path | None = None) -> Study:
    """Read a study.

    Args:
        path: the study's folder, its study.toml, or the name of a bundled study.
        data: folder that stream files are relative to; else what the study says, else its own folder.

    Raises:
        InputError: the study is missing or wrong; with file, line, what was given and what is valid.
    """
    file = resolve_study(path)
    document = read_document(file)
    require_format(document.data.get("format", FORMAT), FORMAT, "study", document.where("format"))
    document.check_keys(document.data, _TOP)
    stated = document.text(document.data, "data", "") or None
    root = data_root(file, stated, None if data is None else Path(data), where=document.where("data"))
    baseline = read_baseline(document)
    streams: dict[str, StreamSpec] = {}
    for name in document.table(document.data, "streams"):
        if name in (*_KEYS, *_GROUPS) or not re.fullmatch(r"[\w-]{1,40}", name):
            raise InputError("a stream cannot have this name", given=name, where=document.where("streams", name))
        streams[name] = read_stream(document, name)
    if not streams:
        raise InputError(
            "the study has no streams", valid='[streams.NAME] with time = "t" and channels', where=str(file)
        )
    streams = geared(streams, read_gears(document, streams))
    trials = read_trials(document, streams, root)
    lists = [index_file(document, table, root, "trials", n) for n, table in enumerate(document.data["trials"])]
    title = document.text(document.data, "title", file.parent.name)
    draft = document.flag(document.data, "draft")
    return Study(
        title[:300],
        file,
        root,
        baseline,
        streams,
        trials,
        draft,
        document.where("draft") if draft else None,
        tuple(dict.fromkeys(path for path in lists if path is not None)),
        _horizon(document),
    )


def _horizon(document: Document) -> float | None:
    """The study's own length of a rollout [s], None where it states none."""
    if "horizon" not in document.data:
        return None
    found = document.number(document.data["horizon"], "horizon")
    if found <= 0.0:
        raise InputError("'horizon' must be positive", given=found, valid="seconds", where=document.where("horizon"))
    return found


def resolve_study(path: str | Path) -> Path:
    """The study file that `path` means: a folder, a study.toml, or the name of a bundled study.

    Raises:
        InputError: there is none; the bundled ones are listed.
    """
    given = Path(path).expanduser()
    try:
        if given.is_dir():
            given = given / "study.toml"
        if given.is_file():
            return given.resolve()
    except (OSError, ValueError):
        raise InputError("not a path", given=str(path), valid="a folder, a study.toml or a bundled study") from None
    bundled = bundled_studies()
    name = str(path).rstrip("/")
    if name in bundled:
        return bundled[name]
    if name.endswith(".toml") or "/" in name or given.name == "study.toml":
        raise InputError(
            "no such study",
            given=str(path),
            valid=f"a folder with a study.toml, or a bundled study: {', '.join(bundled)}",
        )
    raise NotFoundError("study", name, bundled)


def bundled_studies() -> dict[str, Path]:
    """Name -> study file of the studies that ship with the package."""
    try:
        top = folder("studies")
    except FileNotFoundError:
        return {}
    found = sorted(top.glob("**/study.toml"))
    return {str(p.parent.relative_to(top)): p for p in found}
