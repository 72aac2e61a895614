"""The energy ledger of a run: what moves, what is stored, what every element did, and what it took away."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.effects.kernel import Kernel, no_energy, padded
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.memory import no_memory_energy
from spacerobot.simulation.reduced.forces import PRESSED


@dataclass(frozen=True, eq=False)
class Ledger:
    """Energies over time. T times.

    Attributes:
        time: shape (T,) [s].
        kinetic: of everything that moves, shape (T,) [J].
        stored: element -> energy it holds, shape (T,) [J]; elements that store none are absent.
        work: element -> work it did on the bodies since the start, shape (T,) [J].
    """

    time: np.ndarray
    kinetic: np.ndarray
    stored: Mapping[str, np.ndarray]
    work: Mapping[str, np.ndarray]

    @property
    def initial(self) -> float:
        """Kinetic and stored energy at the start [J]; what the balance is measured by."""
        return float(self.kinetic[0] + sum(abs(s[0]) for s in self.stored.values()))

    @property
    def imbalance(self) -> np.ndarray:
        """Kinetic energy gained that no element's work explains, shape (T,) [J]."""
        explained = sum(self.work.values(), start=np.zeros_like(self.kinetic))
        return np.asarray(self.kinetic - self.kinetic[0] - explained)

    @property
    def closure(self) -> float:
        """Largest imbalance over the initial energy; over the most that ever moved, if all began at rest."""
        most = float(self.kinetic.max())
        scale = self.initial if self.initial > np.finfo(float).eps * most else most
        return float(np.abs(self.imbalance).max() / scale) if scale > 0.0 else 0.0

    @property
    def dissipated(self) -> dict[str, np.ndarray]:
        """Element -> energy it took and does not hold, shape (T,) [J]; negative where it brought energy in."""
        out = {}
        for name, work in self.work.items():
            held = self.stored.get(name)
            out[name] = -work if held is None else -(work + held - held[0])
        return out


def stored_in(kernel: Kernel, p: tuple[float, ...], displacement: np.ndarray, rate: np.ndarray) -> np.ndarray | None:
    """Energy [J] that a law holds at displacements and rates of shape (T,); None for a law that stores none."""
    if kernel.energy is no_energy:
        return None
    vector = padded(p)
    return np.array(
        [kernel.energy(d, v, 0.0, vector) for d, v in zip(displacement.tolist(), rate.tolist(), strict=True)]
    )


def stored_by_elements(
    mechanism: Mechanism,
    displacement: Mapping[str, np.ndarray],
    rate: Mapping[str, np.ndarray],
    contact_mode: np.ndarray,
    memory: np.ndarray,
) -> dict[str, np.ndarray]:
    """Energy held by every force, by name; the contact's counts while it is pressed.

    Args:
        mechanism: what there is.
        displacement, rate: by port, shape (T,), "contact" among them.
        contact_mode: shape (T,).
        memory: what laws with a memory keep, shape (T, S).
    """
    found: dict[str, np.ndarray] = {}
    contact = mechanism.contact
    if contact is not None:
        held = stored_in(contact.kernel, contact.p, displacement["contact"], rate["contact"])
        if held is not None:
            found[contact.name] = np.where(contact_mode == PRESSED, held, 0.0)
    for force in mechanism.forces:
        sense = force.sense or force.port
        held = stored_in(force.kernel, force.p, displacement[sense], rate[sense])
        if held is not None:
            found[force.name] = found.get(force.name, 0.0) + held
    for s, state in enumerate(mechanism.states):
        if state.law.energy is not no_memory_energy:
            moves = np.stack([memory[:, s], displacement[state.port], rate[state.port]], axis=1).tolist()
            held = np.array([state.law.energy(z, 0.0, d, v, 1.0, 1.0, state.p) for z, d, v in moves])
            found[state.name] = found.get(state.name, 0.0) + held
    return found
