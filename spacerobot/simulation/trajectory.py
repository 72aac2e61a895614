"""The result of a simulation: channels with units, energies, events; saved to and loaded from one portable file."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from spacerobot.simulation import saved
from spacerobot.simulation.energy import Ledger
from spacerobot.simulation.events import Event
from spacerobot.simulation.peaks import UNKNOWN, Peak
from spacerobot.simulation.restitution import POINT_NOTE, Restitution
from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.files import atomic
from spacerobot.support.jsonio import dumps
from spacerobot.support.showing import Brief, html_table
from spacerobot.support.tables import data_frame, data_set

if TYPE_CHECKING:
    import pandas
    import xarray


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(Brief):
    """One simulated meeting.

    Attributes:
        time: shape (T,) [s].
        channels: name -> values, shape (T,), SI.
        units: name -> unit.
        measured: channel -> what its sensor would record, shape (T,), SI; of the mechanism's readouts.
        ledger: energies at the integrator's own steps.
        events: what switched, and when; a contact that is pressed from the start begins with a touch.
        restitution: three ways, with the contact's times.
        backend: "reduced" or "multibody".
        scene: the scene as TOML text.
        notes: what a reader should know.
        peak_force: the largest contact force [N] and when, on the dense solution: between the samples too.
        peak_deflection: the furthest that the wrist was pushed in [m], likewise.
    """

    time: np.ndarray
    channels: Mapping[str, np.ndarray]
    units: Mapping[str, str]
    measured: Mapping[str, np.ndarray]
    ledger: Ledger
    events: tuple[Event, ...]
    restitution: Restitution
    backend: str
    scene: str = ""
    notes: tuple[str, ...] = field(default=())
    peak_force: Peak = UNKNOWN
    peak_deflection: Peak = UNKNOWN

    def __getitem__(self, channel: str) -> np.ndarray:
        """Values of a channel, shape (T,).

        Raises:
            NotFoundError: no such channel.
        """
        if channel not in self.channels:
            raise NotFoundError("channel", channel, self.channels)
        return self.channels[channel]

    @property
    def linear_momentum(self) -> np.ndarray:
        """Of everything that moves, world axes, shape (T, 3) [kg m/s]; along the approach alone if reduced."""
        return np.column_stack([self.channels[f"momentum.{a}"] for a in "xyz"])

    @property
    def angular_momentum(self) -> np.ndarray:
        """About the world's origin, shape (T, 3) [kg m^2/s]; of the multibody backend."""
        return np.column_stack([self["angular_momentum." + a] for a in "xyz"])

    def _repr_html_(self) -> str:
        r = self.restitution
        rows = [
            ("contact time, first touch to last separation", r.contact_time, "s"),
            ("restitution, target against hand", r.hand, "1"),
            ("restitution, target alone", r.target, "1"),
            ("restitution, at the contact point", r.point, "1"),
            ("touches", r.touches, ""),
            ("largest contact force", self.peak_force.value, "N"),
            ("wrist pushed in by", self.peak_deflection.value, "m"),
            ("energy ledger closes to", self.ledger.closure, "of the initial"),
        ]
        title = f"{self.backend}: {float(self.time[-1]):.4g} s, {len(self.channels)} channels"
        own = (POINT_NOTE,) if r.point > 1.0 else ()
        return html_table(title, rows, ("", "value", "unit"), (*own, *self.notes))

    def to_frame(self) -> pandas.DataFrame:
        """The channels over time, as a table of pandas; its attrs have the units.

        Raises:
            InputError: pandas is not installed.
        """
        return data_frame(self.channels, index=self.time, name="time", units={"time": "s", **self.units})

    def to_xarray(self) -> xarray.Dataset:
        """The channels over time, as a data set of xarray with units.

        Raises:
            InputError: xarray is not installed.
        """
        variables = {name: ("time", values, self.units[name]) for name, values in self.channels.items()}
        return data_set(variables, {"time": ("time", self.time, "s")}, backend=self.backend)

    def save(self, path: str | Path) -> Path:
        """Write a .npz file, whole or not at all; nothing in it is pickled."""
        target = Path(path)
        arrays: dict[str, np.ndarray] = {"time": self.time}
        arrays.update({f"channel/{k}": v for k, v in self.channels.items()})
        arrays.update({f"measured/{k}": v for k, v in self.measured.items()})
        arrays.update({"ledger/time": self.ledger.time, "ledger/kinetic": self.ledger.kinetic})
        arrays.update({f"stored/{k}": v for k, v in self.ledger.stored.items()})
        arrays.update({f"work/{k}": v for k, v in self.ledger.work.items()})
        arrays["event/time"] = np.array([e.time for e in self.events], dtype=float)
        about = {
            "format": saved.FORMAT,
            "backend": self.backend,
            "units": dict(self.units),
            "events": [[e.element, e.kind] for e in self.events],
            "restitution": asdict(self.restitution),
            "peaks": {"force": asdict(self.peak_force), "deflection": asdict(self.peak_deflection)},
            "scene": self.scene,
            "notes": list(self.notes),
        }
        arrays["about"] = np.frombuffer(dumps(about, indent=None).encode(), dtype=np.uint8)
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
        with atomic(target, "wb") as stream:
            stream.write(buffer.getvalue())
        return target

    @classmethod
    def load(cls, path: str | Path) -> Trajectory:
        """Read what `save` wrote.

        Raises:
            InputError: missing, damaged, or no trajectory.
        """
        try:
            arrays, about = saved.read_parts(Path(path))
            time = saved.clock(arrays, "time")
            channels = saved.group(arrays, "channel", len(time))
            measured = saved.group(arrays, "measured", len(time))
            units, backend, scene, notes = saved.words(about, channels)
            return cls(
                time,
                channels,
                units,
                measured,
                saved.ledger(arrays),
                saved.events(saved.line(arrays["event/time"], "event/time", None), about["events"]),
                saved.restitution(about["restitution"]),
                backend,
                scene,
                notes,
                *saved.peaks(about.get("peaks")),
            )
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            raise InputError(f"not a trajectory file ({type(error).__name__}: {error})", given=str(path)) from None
        except InputError as error:
            raise InputError(f"not a trajectory file ({error.what})", given=error.given or str(path)) from None
