"""One HTML file that shows a film: meshcat's own viewer, the film's messages, a stage and a player, all inside."""

from __future__ import annotations

import base64
import hashlib
import importlib.util
import json
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from spacerobot import __version__
from spacerobot.support.errors import SpacerobotError
from spacerobot.support.files import write_text
from spacerobot.support.jsonio import plain
from spacerobot.view.scene3d.film import Film, Readout
from spacerobot.view.scene3d.messages import messages, path_of

_SCRIPTS = ("stage.js", "mass.js", "player.js")


def write_page(film: Film, path: str | Path) -> Path:
    """Write a film as one HTML file that opens offline, whole or not at all; returns its path."""
    write_text(Path(path), page(film))
    return Path(path)


def page(film: Film, *, live: dict[str, Any] | None = None) -> str:
    """The film as HTML text that opens offline and asks nothing of any network.

    Args:
        film: what is shown.
        live: what the sliders of a live page are told; such a page asks the server that it came from for poses, and
            nobody else.
    """
    names = (*_SCRIPTS, "live.js") if live is not None else _SCRIPTS
    plots = (_plots("uPlot.iife.min.js"),) if film.chart else ()
    scripts = (_viewer(), *plots, *(_asset(name) for name in names))
    template = _environment().get_template("scene.html")
    return template.render(
        film=film,
        version=__version__,
        style=_plots("uPlot.min.css") + Markup("\n") + _asset("scene.css") if film.chart else _asset("scene.css"),
        scripts=scripts,
        live=live is not None,
        policy=_policy(scripts) + ("; connect-src 'self'" if live is not None else ""),
        messages=Markup(_script_safe([base64.b64encode(m).decode() for m in messages(film)])),  # noqa: S704
        data=Markup(_script_safe(_data(film) | ({} if live is None else {"live": live}))),  # noqa: S704 - JSON with every bracket escaped
    )


def _script_safe(value: Any) -> str:
    text = json.dumps(plain(value), allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


@cache
def _environment() -> Environment:
    return Environment(
        autoescape=True,
        undefined=StrictUndefined,
        loader=PackageLoader("spacerobot.view.scene3d", "assets"),
        trim_blocks=True,
        lstrip_blocks=True,
    )


@cache
def _asset(name: str) -> Markup:
    path = files("spacerobot.view.scene3d").joinpath("assets", name)
    return Markup(path.read_text(encoding="utf-8").strip())  # noqa: S704 - files of this package


@cache
def _plots(name: str) -> Markup:
    """A file of uPlot, which draws the curve of the time line as it does the curves of reports."""
    path = files("spacerobot.view").joinpath("report", "assets", "uplot", name)
    return Markup(path.read_text(encoding="utf-8").strip())  # noqa: S704 - files of this package


@cache
def _viewer() -> Markup:
    """meshcat's viewer, found without importing meshcat, which would open sockets and load a notebook's machinery."""
    spec = importlib.util.find_spec("meshcat")
    for folder in (spec.submodule_search_locations or []) if spec is not None else []:
        path = Path(folder) / "viewer" / "dist" / "main.min.js"
        if path.is_file():
            text = path.read_text(encoding="utf-8").strip()
            # An end tag inside a string would end the script of the page.
            return Markup(text.replace("</script", "<\\/script"))  # noqa: S704 - a file of an installed package
    raise SpacerobotError("meshcat's viewer is not installed: main.min.js is missing from the package meshcat")


def _policy(scripts: tuple[Markup, ...]) -> str:
    """Only these scripts run, nothing is fetched. Styles may be inline, for the viewer makes its own."""
    digests = (base64.b64encode(hashlib.sha256(str(s).encode()).digest()).decode() for s in scripts)
    allowed = " ".join(f"'sha256-{d}'" for d in digests)
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )


class _Blob:
    """Arrays of numbers behind one another, as the page reads them: (offset, count) in 32-bit floats."""

    def __init__(self) -> None:
        self.parts: list[np.ndarray] = []
        self.size = 0

    def put(self, values: Any) -> list[int]:
        array = np.ascontiguousarray(values, dtype=np.float32).ravel()
        place = [self.size, int(array.size)]
        self.parts.append(array)
        self.size += int(array.size)
        return place

    def text(self) -> str:
        joined = np.concatenate(self.parts) if self.parts else np.zeros(0)
        return base64.b64encode(joined.astype("<f4").tobytes()).decode()


def _data(film: Film) -> dict[str, Any]:
    blob = _Blob()
    bodies = []
    for body in film.bodies:
        entry: dict[str, Any] = {
            "path": path_of(body).strip("/").split("/"),
            "kind": body.kind,
            "poses": blob.put(body.poses),
            "moving": len(body.poses) > 1,
        }
        if body.mismatch is not None:
            entry["mismatch"] = blob.put(np.nan_to_num(body.mismatch))
        if body.beside is not None:
            entry["beside"] = blob.put(body.beside)
        if body.stretch is not None:
            entry["stretch"] = blob.put(body.stretch)
        bodies.append(entry)
    found: dict[str, Any] = {
        "time": blob.put(film.time - film.time[0]),
        "start": float(film.time[0]),
        "length": float(film.time[-1] - film.time[0]),
        "bodies": bodies,
        "trails": [{"name": t.name, "points": blob.put(t.points), "colour": t.colour} for t in film.trails],
        "readouts": [_readout(r, blob) for r in film.readouts],
        "marks": [{"time": m.time - float(film.time[0]), "label": m.label, "quiet": m.quiet} for m in film.marks],
        "gains": film.gains,
        "ghost": film.ghost,
        "chart": film.chart,
        "place": film.place,
        "focus": film.focus,
        "reach": film.reach,
        "floor": film.floor,
        "views": [{"name": v.name, "focus": v.focus, "reach": v.reach, "direction": v.direction} for v in film.views],
    }
    if film.arrow is not None:
        direction = np.broadcast_to(film.arrow.direction, (len(film.time), 3))
        found["arrow"] = {
            "force": blob.put(film.arrow.force),
            "point": blob.put(film.arrow.point),
            "direction": blob.put(direction),
            "scale": film.arrow.scale,
        }
    if film.ellipsoid is not None:
        found["ellipsoid"] = {
            "centre": blob.put(film.ellipsoid.centre),
            "mobility": blob.put(film.ellipsoid.mobility),
            "scale": film.ellipsoid.scale,
            "limit": film.ellipsoid.limit,
        }
    if film.centre_of_mass is not None:
        found["centreOfMass"] = blob.put(film.centre_of_mass)
        found["centreLabel"] = film.centre_label
    found["numbers"] = blob.text()
    return found


def _readout(readout: Readout, blob: _Blob) -> dict[str, Any]:
    found: dict[str, Any] = {"name": readout.name, "unit": readout.unit, "digits": readout.digits}
    found["values"] = blob.put(readout.values)
    if readout.recorded is not None:
        found["recorded"] = blob.put(readout.recorded)
    return found
