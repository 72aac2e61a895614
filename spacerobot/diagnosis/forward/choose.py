"""Which forward model serves a study."""

from __future__ import annotations

from spacerobot.diagnosis.forward.base import ForwardModel
from spacerobot.diagnosis.forward.driven_axis import DrivenAxis
from spacerobot.diagnosis.forward.floating_platform import FloatingPlatform
from spacerobot.diagnosis.forward.free_body import FreeBody
from spacerobot.diagnosis.forward.parts import Parts
from spacerobot.diagnosis.forward.wrist_rig import WristRig
from spacerobot.recordings.study import Study
from spacerobot.support.errors import InputError

MODELS: tuple[type[ForwardModel], ...] = (WristRig, DrivenAxis, FloatingPlatform, FreeBody, Parts)
"""In the order in which they are asked."""


def forward_model(study: Study) -> ForwardModel:
    """The first model that applies.

    Raises:
        InputError: none does; says what each needs.
    """
    for model in MODELS:
        if model.applies(study):
            return model.of(study)
    needs = "; ".join((m.applies.__doc__ or m.kind).split("\n", 1)[0].rstrip(".") for m in MODELS)
    raise InputError(
        "no forward model for this baseline and these channels",
        given=", ".join(study.channels()[:8]),
        valid=needs,
        where=str(study.path),
    )
