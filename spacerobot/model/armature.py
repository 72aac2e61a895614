"""Rotor inertia in a URDF: read from and written to transmissions.

URDF itself has no place for it and Pinocchio reads none, yet behind a gear of 50 it changes the effective
mass of an arm by 20 to 80 %. The tags are those of Drake (`drake:rotor_inertia` and `drake:gear_ratio` in the
actuator of a transmission), so that Drake reads the same files.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin
from lxml import etree

from spacerobot.model.reading import at, number
from spacerobot.support.errors import InputError, NotFoundError

DRAKE = "http://drake.mit.edu"


def read_armature(root: etree._Element, where: str) -> dict[str, float]:
    """Reflected rotor inertia by joint: gear ratio squared times rotor inertia [kg m^2, or kg for a slider].

    The gear ratio is `drake:gear_ratio`, else `mechanicalReduction`, else 1.

    Raises:
        InputError: a number that is none, a negative inertia, or an unknown joint.
    """
    joints = [joint.get("name") for joint in root.findall("joint")]
    found: dict[str, float] = {}
    for transmission in root.findall("transmission"):
        for actuator in transmission.findall("actuator"):
            rotor = actuator.find(f"{{{DRAKE}}}rotor_inertia")
            if rotor is None:
                continue
            element = transmission.find("joint")
            name = "" if element is None else str(element.get("name"))
            if name not in joints:
                raise NotFoundError("joint of a transmission", name, joints, where=at(where, transmission))
            spot = at(where, rotor)
            inertia = number(rotor.get("value"), f"rotor inertia of joint {name!r}", spot)
            ratio = _ratio(actuator, name, where)
            if inertia < 0:
                raise InputError(f"rotor inertia of joint {name!r} is negative", given=inertia, where=spot)
            found[name] = found.get(name, 0.0) + ratio**2 * inertia
    return found


def _ratio(actuator: etree._Element, name: str, where: str) -> float:
    gear = actuator.find(f"{{{DRAKE}}}gear_ratio")
    if gear is not None:
        return number(gear.get("value"), f"gear ratio of joint {name!r}", at(where, gear))
    reduction = actuator.find("mechanicalReduction")
    if reduction is not None and reduction.text:
        return number(reduction.text, f"mechanical reduction of joint {name!r}", at(where, reduction))
    return 1.0


def add_rotors(root: etree._Element, rotors: Mapping[str, tuple[float, float]]) -> None:
    """Append one transmission per joint.

    Args:
        root: the `<robot>` element, changed in place.
        rotors: joint name -> (rotor inertia [kg m^2], gear ratio).
    """
    for name, (inertia, ratio) in rotors.items():
        transmission = etree.SubElement(root, "transmission", name=f"{name}_rotor")
        etree.SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
        etree.SubElement(transmission, "joint", name=name)
        actuator = etree.SubElement(transmission, "actuator", name=f"{name}_rotor_motor")
        etree.SubElement(actuator, f"{{{DRAKE}}}gear_ratio", nsmap={"drake": DRAKE}, value=repr(float(ratio)))
        etree.SubElement(actuator, f"{{{DRAKE}}}rotor_inertia", nsmap={"drake": DRAKE}, value=repr(float(inertia)))


def armature_vector(model: pin.Model, reflected: Mapping[str, float]) -> np.ndarray:
    """Shape (nv,): `reflected` [kg m^2 or kg] laid out as `model.armature`."""
    armature = np.zeros(model.nv)
    for name, value in reflected.items():
        if model.existJointName(name):
            joint = model.joints[model.getJointId(name)]
            armature[joint.idx_v : joint.idx_v + joint.nv] = value
    return armature
