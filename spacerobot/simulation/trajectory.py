"""The result of a simulation: channels with units, energies, events; saved to and loaded from one portable file."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from spacerobot.simulation.energy import Ledger
from spacerobot.simulation.events import Event
from spacerobot.simulation.restitution import Restitution
from spacerobot.support.errors import InputError, NotFoundError
from spacerobot.support.files import atomic
from spacerobot.support.jsonio import dumps

FORMAT = 1


@dataclass(frozen=True, eq=False)
class Trajectory:
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
            "format": FORMAT,
            "backend": self.backend,
            "units": dict(self.units),
            "events": [[e.element, e.kind] for e in self.events],
            "restitution": asdict(self.restitution),
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
            with np.load(Path(path), allow_pickle=False) as archive:
                arrays = {key: archive[key] for key in archive.files}
            about: dict[str, Any] = json.loads(bytes(arrays["about"]).decode())
            if about["format"] != FORMAT:
                raise InputError("unknown format of a trajectory", given=about["format"], valid=str(FORMAT))
            times = arrays["event/time"].tolist()
            events = tuple(Event(t, *pair) for t, pair in zip(times, about["events"], strict=True))
            restitution: dict[str, Any] = {k: float("nan") if v is None else v for k, v in about["restitution"].items()}
            return cls(
                arrays["time"],
                _under(arrays, "channel"),
                about["units"],
                _under(arrays, "measured"),
                Ledger(
                    arrays["ledger/time"], arrays["ledger/kinetic"], _under(arrays, "stored"), _under(arrays, "work")
                ),
                events,
                Restitution(**restitution),
                about["backend"],
                about["scene"],
                tuple(about["notes"]),
            )
        except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
            raise InputError(f"not a trajectory file ({type(error).__name__}: {error})", given=str(path)) from None


def _under(arrays: Mapping[str, np.ndarray], group: str) -> dict[str, np.ndarray]:
    return {key.split("/", 1)[1]: value for key, value in arrays.items() if key.startswith(f"{group}/")}
