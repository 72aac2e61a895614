"""Names and units of effects where what moves is an angle."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

from msgspec.structs import replace

from spacerobot.diagnosis.answer.record import Effect


def counted_in_angles(effects: Iterable[Effect], turns: Callable[[str], bool]) -> list[Effect]:
    """Effects with parameters named and counted in angles where what moves at their place turns."""
    out = []
    for found in effects:
        if turns(found.where):
            angles = {of_turning(n): replace(v, unit=turning_unit(v.unit)) for n, v in found.parameters.items()}
            found = replace(found, parameters=angles)
        out.append(found)
    return out


def of_turning(name: str) -> str:
    """A parameter's name where its effect sits on something that turns: force_N is force_Nm."""
    for ending, by in _TURNED:
        if re.search(ending, name):
            return re.sub(ending, by, name)
    return name


_TURNED = (
    (r"_Ns2_m2$", "_Nms2_rad2"),
    (r"_Ns_m$", "_Nms_rad"),
    (r"_N_m3$", "_Nm_rad3"),
    (r"_N_m$", "_Nm_rad"),
    (r"_m_s$", "_rad_s"),
    (r"_Ns$", "_Nms"),
    (r"_kg$", "_kgm2"),
    (r"_N$", "_Nm"),
    (r"_m$", "_rad"),
)


def turning_unit(unit: str) -> str:
    """The unit of the same law about an axis: N is N m, m is rad, kg is kg m^2."""
    above, _, below = unit.partition("/")
    above = {"N": "N m", "kg": "kg m^2", "m": "rad"}.get(above, above.replace("N s", "N m s"))
    return f"{above}/{below.replace('m', 'rad')}" if below else above
