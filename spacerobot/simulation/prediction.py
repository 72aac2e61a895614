"""What theory expects of a scene: the reduced model's contact time and restitution, Eqs. 9 to 18."""

from __future__ import annotations

import math
from dataclasses import dataclass

from spacerobot.effects.laws import REFERENCE_PENETRATION
from spacerobot.simulation.parts.contact import EXPONENTS
from spacerobot.simulation.scene import Scene
from spacerobot.theory import contact_time, exact, power_law, restitution
from spacerobot.theory.equations_of_motion import ThreeMasses
from spacerobot.theory.reduction import Reduced, reduced_mass, total_damping


@dataclass(frozen=True)
class Prediction:
    """The reduced model of Uyama et al. (2012) under both end conditions.

    Attributes:
        reduced_mass: m~ of Eq. 10 [kg].
        damping: c_w + c_eq [N s/m].
        damping_ratio: zeta.
        contact_time: Eq. 16, the spring relaxed again [s]; infinite from critical damping on.
        contact_time_unilateral: to the first zero of the force [s].
        restitution: Eq. 18, of target against hand; zero from critical damping on.
        restitution_unilateral: the same to the first zero of the force.
        restitution_without_equivalent: Eq. 18 with c_w alone.
    """

    reduced_mass: float
    damping: float
    damping_ratio: float
    contact_time: float
    contact_time_unilateral: float
    restitution: float
    restitution_unilateral: float
    restitution_without_equivalent: float


def predict(scene: Scene) -> Prediction | None:
    """What Eqs. 9 to 18 expect; None where there is no wrist spring or the hand is on a spring of its own."""
    if scene.wrist.stiffness <= 0.0 or scene.hand.stiffness > 0.0:
        return None
    mass = reduced_mass(scene.hand.mass, scene.wrist.mass + scene.target.mass)
    wrist = scene.wrist
    model = Reduced(mass, wrist.stiffness, total_damping(wrist.damping, wrist.equivalent_damping, "wrist+equivalent"))
    bare = Reduced(mass, wrist.stiffness, wrist.damping)
    return Prediction(
        reduced_mass=mass,
        damping=model.damping,
        damping_ratio=model.damping_ratio,
        contact_time=contact_time.displacement_zero(model),
        contact_time_unilateral=contact_time.force_zero(model),
        restitution=restitution.displacement_zero(model),
        restitution_unilateral=restitution.force_zero(model),
        restitution_without_equivalent=restitution.displacement_zero(bare),
    )


@dataclass(frozen=True)
class ThreeMassPrediction:
    """Eqs. 2 to 4 solved exactly from the first touch: contact spring, all re-contacts, unilateral contact.

    Attributes:
        contact_time: first touch to last separation [s]; infinite if they touch at the end.
        contact_time_summed: time in which the contact carried force [s].
        touches: how often.
        restitution_target: -(v_t' - v_h)/(v_t - v_h) at the last separation.
        restitution_hand: -(v_t' - v_h')/(v_t - v_h).
    """

    contact_time: float
    contact_time_summed: float
    touches: int
    restitution_target: float
    restitution_hand: float


def predict_exact(scene: Scene, duration: float) -> ThreeMassPrediction | None:
    """Eqs. 2 to 4 without any reduction.

    None where the scene is not theirs (effects, other contact laws, gravity), or touches a thousand times and more.

    Args:
        scene: what there is.
        duration: of the simulation, arrival included [s].
    """
    contact, wrist, target = scene.contact, scene.wrist, scene.target
    plain = contact.law == "kelvin_voigt" and not contact.bilateral and not contact.adhesion and not contact.mu
    turned = any(target.spin) or any(target.contact_point[1:]) or any(target.attitude)
    rest = any(scene.gravity) or turned or bool(target.drift or wrist.deflection or wrist.deflection_rate)
    rest = rest or scene.motion.moves_robot
    if not plain or rest or scene.effects or scene.hand.stiffness > 0.0 or wrist.stiffness <= 0.0:
        return None
    system = ThreeMasses(
        hand_mass=scene.hand.mass,
        wrist_mass=wrist.mass,
        target_mass=target.mass,
        wrist_stiffness=wrist.stiffness,
        wrist_damping=wrist.damping + wrist.equivalent_damping,
        contact_stiffness=contact.stiffness,
        contact_damping=contact.damping,
        guide_friction=wrist.guide_friction,
    )
    hand = -scene.hand_speed
    try:
        motion = exact.solve(system, target.speed, hand_velocity=hand, duration=max(duration - scene.arrival, 1e-9))
    except ArithmeticError:
        return None
    touches = len(motion.times_of("touch"))
    summed, lasted = motion.summed_contact_time, motion.contact_time
    if not math.isfinite(lasted):
        return ThreeMassPrediction(lasted, summed, touches, math.nan, math.nan)
    after = motion.state(lasted)
    approach = target.speed - hand
    return ThreeMassPrediction(
        lasted,
        summed,
        touches,
        float(-(after[5] - hand) / approach),
        float(-(after[5] - after[3]) / approach),
    )


def expected_contact_time(scene: Scene) -> float:
    """How long the contact may last, for choosing a duration [s]; infinite if nothing brings the target back."""
    if scene.wrist.stiffness <= 0.0:
        return math.inf
    hand = math.inf if scene.hand.stiffness > 0.0 else scene.hand.mass
    stiffness = scene.wrist.stiffness
    if scene.hand.stiffness > 0.0:
        stiffness = 1.0 / (1.0 / stiffness + 1.0 / scene.hand.stiffness)
    model = Reduced(
        reduced_mass(hand, scene.wrist.mass + scene.target.mass),
        stiffness,
        scene.wrist.damping + scene.wrist.equivalent_damping,
    )
    return max(contact_time.force_zero(model), math.pi / model.frequency, _surface_time(scene))


def _surface_time(scene: Scene) -> float:
    """How long the surfaces alone would press, which is what counts behind a wrist that hardly gives [s]."""
    contact, speed = scene.contact, scene.touching_speed
    if speed <= 0.0:
        return 0.0
    exponent = EXPONENTS[contact.law] if contact.exponent is None else contact.exponent
    stiffness = contact.stiffness * REFERENCE_PENETRATION ** (1.0 - exponent)
    return power_law.contact_time(scene.target.mass, stiffness, speed, exponent)
