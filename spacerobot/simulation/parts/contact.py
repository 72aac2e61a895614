"""The contact law of a scene."""

from __future__ import annotations

from dataclasses import dataclass

from spacerobot.simulation.parts.checks import check_fields, number
from spacerobot.support.errors import InputError, NotFoundError

LAWS = ("kelvin_voigt", "hertz", "hunt_crossley")
EXPONENTS = {"kelvin_voigt": 1.0, "hertz": 1.5, "hunt_crossley": 1.5}


@dataclass(frozen=True)
class ContactLaw:
    """How the surfaces push: F = k d_ref (d/d_ref)^n (1 + (chi/k) d') + c d', with d_ref = 1 mm.

    Attributes:
        stiffness: k [N/m].
        damping: c [N s/m].
        law: "kelvin_voigt" (n = 1, chi = 0), "hertz" (n = 1.5, chi = 0) or "hunt_crossley" (n = 1.5, c = 0).
        exponent: n, if another than the law's own.
        chi_over_k: chi/k of Hunt and Crossley [s/m].
        bilateral: the paper's reading: the contact pulls, and ends when the penetration is back at zero.
        mu: Coulomb friction coefficient at the point.
        adhesion: tension that the surfaces bear before they part [N].
    """

    stiffness: float = 68000.0
    damping: float = 0.0
    law: str = "kelvin_voigt"
    exponent: float | None = None
    chi_over_k: float = 0.0
    bilateral: bool = False
    mu: float = 0.0
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        check_fields(
            self,
            "contact",
            stiffness=(0.0, True),
            damping=(0.0, False),
            chi_over_k=(0.0, False),
            mu=(0.0, False),
            adhesion=(0.0, False),
        )
        if self.law not in LAWS:
            raise NotFoundError("contact law", str(self.law), LAWS, where="contact.law")
        if not isinstance(self.bilateral, bool):
            raise InputError("must be true or false", given=self.bilateral, where="contact.bilateral")
        if self.exponent is not None:
            found = number(self.exponent, "contact.exponent", minimum=0.5)
            object.__setattr__(self, "exponent", found)
            if self.law == "kelvin_voigt" and found != 1.0:
                raise InputError(
                    "kelvin_voigt has exponent 1", given=found, valid='law = "hertz"', where="contact.exponent"
                )
        if self.chi_over_k > 0.0 and self.law != "hunt_crossley":
            raise InputError(
                f"{self.law} has no chi_over_k",
                given=self.chi_over_k,
                valid='law = "hunt_crossley"',
                where="contact.chi_over_k",
            )
        if self.damping > 0.0 and self.law == "hunt_crossley":
            raise InputError(
                "hunt_crossley takes its damping from chi_over_k", given=self.damping, where="contact.damping"
            )
        if self.bilateral and self.adhesion > 0.0:
            raise InputError("a bilateral contact pulls already", given=self.adhesion, where="contact.adhesion")

    @property
    def parameters(self) -> tuple[float, float, float, float]:
        """(k, c, n, chi/k) as the contact kernel reads them."""
        n = EXPONENTS[self.law] if self.exponent is None else self.exponent
        return self.stiffness, self.damping, n, self.chi_over_k
