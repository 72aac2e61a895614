"""A mechanism: coordinates, ports and primitives; immutable, edited by returning a new one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from spacerobot.effects.primitives import (
    ChannelMap,
    Contact,
    Coordinate,
    Field,
    Force,
    Friction,
    Impulse,
    Input,
    Load,
    Readout,
    State,
)
from spacerobot.support.errors import InputError, NotFoundError


@dataclass(frozen=True)
class Mechanism:
    """What there is to simulate, in primitives.

    Attributes:
        coordinates: absolute degrees of freedom by name, constant mass (the reduced form).
        ports: port name -> {coordinate: coefficient}; d = sum of coefficient times coordinate.
        contact: the contact between `wrist` and `target`, or None.
        forces, frictions, states, fields, impulses, inputs: what acts.
        readouts: what the channels show, by channel.
        maps: what sensors do to channels.
        sensors: sensor (stream) name -> its channels, so that an effect can sit at a sensor.
        links: "link.NAME" of each link of a robot that moves and that a load can be fixed to.
        loads: what is fixed to them.
        level: ports of a robot's joints that slide level, whatever it carries.
        gravity: acceleration [m/s^2], shape (3,), in the world's axes; None where bodies feel it along their
            coordinates alone (`fields`).
    """

    coordinates: Mapping[str, Coordinate]
    ports: Mapping[str, Mapping[str, float]]
    contact: Contact | None = None
    forces: tuple[Force, ...] = ()
    frictions: tuple[Friction, ...] = ()
    states: tuple[State, ...] = ()
    fields: tuple[Field, ...] = ()
    impulses: tuple[Impulse, ...] = ()
    inputs: tuple[Input, ...] = ()
    readouts: Mapping[str, Readout] = field(default_factory=dict)
    maps: tuple[ChannelMap, ...] = ()
    sensors: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    links: tuple[str, ...] = ()
    loads: tuple[Load, ...] = ()
    level: tuple[str, ...] = ()
    gravity: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        for port, row in self.ports.items():
            for name in row:
                if name not in self.coordinates:
                    raise NotFoundError("coordinate", name, self.coordinates, where=f"port {port}")
        acting: tuple[Force | Friction | State | Impulse | Input, ...]
        acting = (*self.forces, *self.frictions, *self.states, *self.impulses, *self.inputs)
        for element in acting:
            self._require_port(element.port, element.name)
        for item in self.fields:
            if item.body not in self.coordinates:
                raise NotFoundError("coordinate", item.body, self.coordinates, where=f"field {item.name}")

    def _require_port(self, port: str, where: str) -> None:
        if port not in self.ports and not (self.contact and port in ("contact", "contact.slide")):
            raise NotFoundError("port", port, self.ports, where=where)

    def with_force(self, *forces: Force) -> Mechanism:
        """This mechanism with further forces."""
        return replace(self, forces=(*self.forces, *forces))

    def with_friction(self, *frictions: Friction) -> Mechanism:
        """This mechanism with further friction."""
        return replace(self, frictions=(*self.frictions, *frictions))

    def with_state(self, *states: State) -> Mechanism:
        """This mechanism with further laws that remember."""
        return replace(self, states=(*self.states, *states))

    def with_field(self, *fields: Field) -> Mechanism:
        """This mechanism with further uniform accelerations."""
        return replace(self, fields=(*self.fields, *fields))

    def with_impulse(self, impulse: Impulse) -> Mechanism:
        """This mechanism with a further kick."""
        return replace(self, impulses=(*self.impulses, impulse))

    def with_load(self, load: Load) -> Mechanism:
        """This mechanism with a further load on one of its links."""
        if load.link not in self.links:
            raise NotFoundError("link", load.link, self.links)
        return replace(self, loads=(*self.loads, load))

    def with_pull(self, pull: tuple[float, float, float]) -> Mechanism:
        """This mechanism under a further acceleration of all that has mass [m/s^2], in the world's axes.

        Raises:
            InputError: its bodies feel gravity along their coordinates alone.
        """
        if self.gravity is None:
            raise InputError("this mechanism knows of no gravity in space")
        x, y, z = (g + p for g, p in zip(self.gravity, pull, strict=True))
        return replace(self, gravity=(x, y, z))

    def with_map(self, *maps: ChannelMap) -> Mechanism:
        """This mechanism with further channel maps."""
        return replace(self, maps=(*self.maps, *maps))

    def with_contact(self, change: Callable[[Contact], Contact]) -> Mechanism:
        """This mechanism with its contact edited.

        Raises:
            InputError: there is no contact.
        """
        if self.contact is None:
            raise InputError("this mechanism has no contact")
        return replace(self, contact=change(self.contact))

    def with_forces_changed(self, role: str, port: str, change: Callable[[Force], Force | None]) -> Mechanism:
        """This mechanism with every force of a role at a port edited, or dropped where `change` returns None."""
        forces = []
        for force in self.forces:
            new = change(force) if force.role == role and force.port == port else force
            if new is not None:
                forces.append(new)
        return replace(self, forces=tuple(forces))

    def with_mass(self, coordinate: str, mass: float) -> Mechanism:
        """This mechanism with a coordinate's mass [kg or kg m^2] replaced."""
        if coordinate not in self.coordinates:
            raise NotFoundError("coordinate", coordinate, self.coordinates)
        coordinates = dict(self.coordinates)
        coordinates[coordinate] = replace(coordinates[coordinate], mass=mass)
        return replace(self, coordinates=coordinates)

    def with_appendage(self, coordinate: Coordinate, port: str, row: Mapping[str, float], *forces: Force) -> Mechanism:
        """This mechanism with a further coordinate, the port that carries it, and the forces that hold it."""
        if coordinate.name in self.coordinates:
            raise InputError("a coordinate of this name is already there", given=coordinate.name)
        return replace(
            self,
            coordinates={**self.coordinates, coordinate.name: coordinate},
            ports={**self.ports, port: dict(row)},
            forces=(*self.forces, *forces),
        )

    def with_port_row(self, port: str, coordinate: str, coefficient: float) -> Mechanism:
        """This mechanism with one coefficient of a port's row replaced."""
        row = {**self.ports[port], coordinate: coefficient}
        return replace(self, ports={**self.ports, port: row})

    def with_sideways(self) -> Mechanism:
        """This mechanism with the target free to move sideways too, as heavy as it is along."""
        if "target.y" in self.coordinates or "target" not in self.coordinates:
            return self
        carried = sum(c.mass for c in self.coordinates.values() if c.carrier == "target")
        across = Coordinate("target.y", self.coordinates["target"].mass + carried)
        return replace(
            self.with_appendage(across, "target.y", {"target.y": 1.0}),
            readouts={"target.y": Readout("target.y", "position", "target.y"), **self.readouts},
        )

    def carrier_of(self, name: str) -> str | None:
        """The coordinate whose motion an appendage shares while its own spring stays as it is.

        What turns in a carrier that slides shares the carrier's yaw. None for what rides on nothing that moves here.
        """
        own = self.coordinates[name]
        if own.carrier is None:
            return None
        carrier = self.coordinates.get(own.carrier)
        turns = carrier is not None and carrier.angular
        found = f"{own.carrier}.yaw" if own.angular and not turns else own.carrier
        return found if found in self.coordinates else None

    def rides_on(self, rider: str, name: str) -> bool:
        """Whether a coordinate is that one, or moves along with it."""
        carrier = self.carrier_of(rider)
        return rider == name or (carrier is not None and self.rides_on(carrier, name))

    def at_start(self, values: Mapping[str, float]) -> dict[str, float]:
        """Positions (or velocities) of all coordinates at the start, by name.

        Args:
            values: of some coordinates [m or rad, m/s or rad/s]. An appendage that is not named starts along with
                its carrier, as it would after a long flight together; whatever else is not named starts at zero.

        Raises:
            NotFoundError: a name that is no coordinate.
        """
        for name in values:
            if name not in self.coordinates:
                raise NotFoundError("coordinate", name, self.coordinates)

        def value(name: str) -> float:
            carrier = self.carrier_of(name)
            if name in values or carrier is None:
                return float(values.get(name, 0.0))
            return value(carrier)

        return {name: value(name) for name in self.coordinates}

    def angular(self, port: str) -> bool:
        """Whether a port's displacement is an angle."""
        row = self.ports.get(port, {})
        return any(self.coordinates[name].angular for name in row)
