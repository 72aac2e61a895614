"""A stream: one kind of file that every trial may have, and how its columns become channels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from spacerobot.recordings import units
from spacerobot.recordings.channel import MOMENTS, ChannelSpec
from spacerobot.recordings.document import Document
from spacerobot.recordings.sensor_filter import read_filter
from spacerobot.support.errors import InputError, NotFoundError

FORMATS = ("csv", "text", "motive", "nexus", "mat", "hdf5", "npz", "bag", "xlsx")
COMPRESSIONS = ("none", "gz", "bz2", "xz")
ENCODINGS = (
    "utf-8",
    "utf-16",
    "utf-16-le",
    "utf-16-be",
    "utf-32",
    "ascii",
    "latin-1",
    "cp1252",
    "shift_jis",
    "gb18030",
)
REPEATED = ("keep", "drop", "first")
KINDS = ("samples", "events")
SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t", "space": " ", "pipe": "|"}

_KEYS = (
    "time",
    "time_unit",
    "time_offset",
    "rate",
    "channels",
    "format",
    "variable",
    "separator",
    "decimal",
    "header_rows",
    "rows",
    "reshape",
    "compression",
    "clock",
    "kind",
    "missing",
    "repeated",
    "sort",
    "encoding",
)
_CHANNEL_KEYS = (
    "is", "sigma", "unit", "scale", "offset", "offset_sigma", "use", "missing", "moment", "unwrap", "plus", "frame",
    "filter",
)  # fmt: skip


@dataclass(frozen=True)
class StreamSpec:
    """How files of one kind are read.

    Attributes:
        name: the stream's name in the study.
        channels: what is read from it.
        time: the time column (name, or index from 0 as text), None where `rate` gives the times.
        time_unit: unit of the time column; None for what the file says of it, and s where it says nothing.
        time_offset: added to the times to bring them onto the clock, s.
        rate: samples per second where the file has no times, Hz.
        format: one of FORMATS, None to decide by the file's name and first bytes.
        variable: array of a MAT, HDF5 or npz file, topic of a bag, sheet of a workbook, or table of a Vicon export.
        separator: between the cells of a text table, None to find out.
        decimal: "." or ",", None to find out.
        header_rows: lines before the data, None to find out.
        rows: first and one past the last data row, from 0; None for all.
        reshape: number of interleaved values a row (joints one after the other, one value a line).
        compression: one of COMPRESSIONS, None to decide by the file's name and first bytes.
        clock: name of the clock; streams with the same name share it. "own" makes it the stream's own.
        kind: "samples" in time, or "events" (each row a before and after).
        missing: raw readings that mean "no reading", for every channel.
        repeated: "keep" flags rows that repeat the row before, "drop" leaves them out, "first" leaves out rows whose
            time alone does not move on.
        sort: sort rows by time instead of refusing a clock that runs backwards.
        encoding: one of ENCODINGS, None to find out.
    """

    name: str
    channels: tuple[ChannelSpec, ...]
    time: str | None = None
    time_unit: str | None = None
    time_offset: float = 0.0
    rate: float | None = None
    format: str | None = None
    variable: str | None = None
    separator: str | None = None
    decimal: str | None = None
    header_rows: int | None = None
    rows: tuple[int, int | None] | None = None
    reshape: int | None = None
    compression: str | None = None
    clock: str = "shared"
    kind: str = "samples"
    missing: tuple[float, ...] = ()
    repeated: str = "keep"
    sort: bool = False
    encoding: str | None = None

    @property
    def own_clock(self) -> bool:
        """Whether the offset of this stream's clock from the others is unknown."""
        return self.clock != "shared"


def read_stream(document: Document, name: str) -> StreamSpec:
    """The table `[streams.NAME]`, checked.

    Raises:
        InputError: an unknown key, channel or unit, or settings that contradict each other.
    """
    path = ("streams", name)
    table = document.table(document.table(document.data, "streams"), name, "streams")
    document.check_keys(table, _KEYS, *path)

    def choice(key: str, known: tuple[str, ...]) -> str | None:
        if key not in table:
            return None
        value = document.text(table, key, "", *path)
        if value not in known:
            raise NotFoundError(f"value of {key!r}", value, known, where=document.where(*path, key))
        return value

    def count(key: str, least: int) -> int | None:
        value = table.get(key)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= 100_000:
            raise InputError(
                f"{key!r} must be a whole number of at least {least}",
                given=value,
                where=document.where(*path, key),
            )
        return value

    kind = choice("kind", KINDS) or "samples"
    time = column_name(document, table["time"], *path, "time") if "time" in table else None
    rate = document.number(table["rate"], *path, "rate") if "rate" in table else None
    if rate is not None and rate <= 0:
        raise InputError("rate must be above 0 Hz", given=rate, where=document.where(*path, "rate"))
    if kind == "samples" and (time is None) == (rate is None):
        raise InputError(
            "a stream needs its times",
            given="both" if rate else "neither time nor rate",
            valid="time = COLUMN, or rate = HZ",
            where=document.where(*path),
        )
    time_unit = document.text(table, "time_unit", "", *path) or None
    if time_unit is not None:
        units.factor(time_unit, ("time",), where=document.where(*path, "time_unit"))
    clock = document.text(table, "clock", "shared", *path)
    separator = document.text(table, "separator", "", *path) if "separator" in table else None
    if separator is not None:
        separator = SEPARATORS.get(separator, separator)
        if separator not in SEPARATORS.values():
            raise NotFoundError("separator", separator, SEPARATORS, where=document.where(*path, "separator"))
    missing = read_missing(document, table.get("missing", []), *path, "missing")
    return StreamSpec(
        name=name,
        channels=_channels(document, table, kind, missing, *path),
        time=time,
        time_unit=time_unit,
        time_offset=document.number(table.get("time_offset", 0.0), *path, "time_offset"),
        rate=rate,
        format=choice("format", FORMATS),
        variable=document.text(table, "variable", "", *path) or None,
        separator=separator,
        decimal=choice("decimal", (".", ",")),
        header_rows=count("header_rows", 0),
        rows=read_rows(document, table["rows"], *path, "rows") if "rows" in table else None,
        reshape=count("reshape", 1),
        compression=choice("compression", COMPRESSIONS),
        clock=f"own:{name}" if clock == "own" else clock,
        kind=kind,
        missing=missing,
        repeated=choice("repeated", REPEATED) or "keep",
        sort=document.flag(table, "sort", *path),
        encoding=choice("encoding", ENCODINGS),
    )


def column_name(document: Document, value: object, *path: str | int) -> str:
    """A column by name, or by index from 0, as text."""
    if isinstance(value, str) and value:
        return value
    if isinstance(value, int) and not isinstance(value, bool) and value >= 0:
        return str(value)
    raise InputError(
        f"{path[-1]!r} must be a column's name or its index from 0", given=value, where=document.where(*path)
    )


def read_rows(document: Document, value: object, *path: str | int) -> tuple[int, int | None]:
    """`rows = [a, b]`: data rows a to b - 1, counted from 0; b may be left out."""
    if (
        isinstance(value, list)
        and 1 <= len(value) <= 2
        and all(isinstance(v, int) and not isinstance(v, bool) and v >= 0 for v in value)
        and (len(value) == 1 or value[0] < value[1])
    ):
        return value[0], value[1] if len(value) == 2 else None
    raise InputError("'rows' must be [first, one past the last]", given=value, where=document.where(*path))


def read_missing(document: Document, value: object, *path: str | int) -> tuple[float, ...]:
    """A reading, or a list of readings, that mean "no reading"."""
    return document.vector(value if isinstance(value, list) else [value], None, *path)


def _channels(
    document: Document, table: Mapping[str, Any], kind: str, missing: tuple[float, ...], *path: str
) -> tuple[ChannelSpec, ...]:
    path = (*path, "channels")
    found: list[ChannelSpec] = []
    for column, given in _leaves(document, document.table(table, "channels", *path[:-1]), *path):
        for spec in given if isinstance(given, list) else [given]:
            found.append(_channel(document, column, spec, kind, missing, *path))
    if not found:
        raise InputError(
            "the stream has no channels",
            valid='channels.COLUMN = { is = "target.x" }',
            where=document.where(*path),
        )
    seen: dict[str, str] = {}
    for channel in found:
        if channel.name in seen:
            raise InputError(
                f"two columns are both {channel.name}",
                given=f"{seen[channel.name]}, {channel.column}",
                where=channel.where,
            )
        seen[channel.name] = channel.column
    return tuple(found)


def _leaves(document: Document, table: Mapping[str, Any], *path: str) -> list[tuple[str, Any]]:
    """(column, specification) pairs; an unquoted dotted column arrives as nested tables."""
    found: list[tuple[str, Any]] = []
    for key, value in table.items():
        listed = isinstance(value, list) and bool(value) and all(isinstance(v, dict) for v in value)
        if listed or (isinstance(value, dict) and (not value or any(not isinstance(v, dict) for v in value.values()))):
            found.append((key, value))
        elif isinstance(value, dict):
            found += [(f"{key}.{inner}", leaf) for inner, leaf in _leaves(document, value, *path, key)]
        else:
            raise InputError(
                "a channel must be a table",
                given=value,
                valid='COLUMN = { is = "target.x" }',
                where=document.where(*path, key),
            )
    return found


def _channel(
    document: Document,
    column: str,
    spec: Mapping[str, Any],
    kind: str,
    missing: tuple[float, ...],
    *path: str,
) -> ChannelSpec:
    path = (*path, column)
    document.check_keys(spec, _CHANNEL_KEYS, *path)
    where = document.where(*path)
    if "is" not in spec:
        raise InputError("a channel must say what it is", given=column, valid='is = "target.x"', where=where)
    name = document.text(spec, "is", "", *path)
    moment = spec.get("moment", "event" if kind == "events" else None)
    if moment is not None and (kind != "events" or moment not in MOMENTS):
        raise InputError(
            "'moment' belongs to a stream of kind \"events\"",
            given=moment,
            valid=", ".join(MOMENTS),
            where=where,
        )
    unit = document.text(spec, "unit", "", *path) or None

    def number(key: str, default: float) -> float:
        return document.number(spec[key], *path, key) if key in spec else default

    plus, plus_sigma = _plus(document, spec, *path)
    sigma = number("sigma", 0.0) if "sigma" in spec else None
    if sigma is not None and unit is not None:
        sigma *= units.unit(unit, where=where).factor
    return ChannelSpec(
        column=column,
        name=name if moment in (None, "event") else f"{name}.{moment}",
        sigma=sigma,
        unit=unit,
        scale=number("scale", 1.0),
        offset=number("offset", 0.0),
        offset_sigma=number("offset_sigma", 0.0),
        use=document.text(spec, "use", "output", *path),
        missing=read_missing(document, spec["missing"], *path, "missing") if "missing" in spec else missing,
        unwrap=document.flag(spec, "unwrap", *path),
        moment=None if moment == "event" else moment,
        plus=plus,
        plus_sigma=plus_sigma,
        frame=document.text(spec, "frame", "world", *path),
        filter=read_filter(document, spec, *path),
        where=where,
    )


def _plus(
    document: Document, spec: Mapping[str, Any], *path: str
) -> tuple[tuple[tuple[str, float], ...], tuple[tuple[str, float], ...]]:
    """`plus = { COLUMN = factor }`: columns that are added, by name or index; `[factor, sigma]` where it is doubted."""
    factors, sigmas = [], []
    for column, given in document.table(spec, "plus", *path).items():
        factor = given
        if isinstance(given, list):
            factor, sigma = document.vector(given, 2, *path, "plus", column)
            sigmas.append((column, sigma))
        factors.append((column, document.number(factor, *path, "plus", column)))
    return tuple(factors), tuple(sigmas)
