"""What a scene is made of, each a frozen record that refuses values no rig can have; one a file."""

from spacerobot.simulation.parts.contact import ContactLaw
from spacerobot.simulation.parts.effect_at import EffectAt
from spacerobot.simulation.parts.motion import Motion
from spacerobot.simulation.parts.servo import Servo
from spacerobot.simulation.parts.target import Target
from spacerobot.simulation.parts.wrist import Wrist

__all__ = ["ContactLaw", "EffectAt", "Motion", "Servo", "Target", "Wrist"]
