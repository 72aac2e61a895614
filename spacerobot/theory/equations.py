"""The paper's equations by number: what each says, where it lives here, and how sure its number is.

The paper's text does not ship with this project. "given" marks equations whose content and number are
established; "reconstructed" marks links of the chain from the equations of motion to the closed forms that
the derivation needs at that place, whose number (never whose truth) is our reading. Every formula is tested
against an independent numerical integration, whatever its status.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Status = Literal["given", "reconstructed", "not as printed"]


@dataclass(frozen=True)
class Equation:
    """One numbered equation.

    Attributes:
        number: in the paper.
        says: the formula in plain text.
        where: module and name under spacerobot.theory.
        status: "given", "reconstructed" or "not as printed".
    """

    number: int
    says: str
    where: str
    status: Status


EQUATIONS = (
    Equation(1, "M = 1/(nᵀ J H⁻¹ Jᵀ n)", "equations_of_motion.equivalent_mass", "reconstructed"),
    Equation(2, "M ẍ_h = k_w s + c ṡ", "equations_of_motion.ThreeMasses", "given"),
    Equation(3, "m_w ẍ_w = −k_w s − c ṡ + F", "equations_of_motion.ThreeMasses", "given"),
    Equation(4, "m_t ẍ_t = −F,  F = k_c d + c_c ḋ", "equations_of_motion.ThreeMasses", "given"),
    Equation(5, "ω⁴ − (ω_w² + ω_c²) ω² + X ω_w² ω_c² = 0", "frequencies.exact", "not as printed"),
    Equation(6, "ω_c² = k_c (m_w + m_t)/(m_w m_t)", "frequencies.contact_frequency", "given"),
    Equation(7, "ω_w² = k_w (M + m_w)/(M m_w)", "frequencies.wrist_frequency", "given"),
    Equation(8, "ω_low → √X ω_w,  ω_high → ω_c  for ω_c ≫ ω_w", "frequencies.separated", "reconstructed"),
    Equation(9, "ω = √(k_w/m̃)", "reduction.reduced_frequency", "given"),
    Equation(10, "m̃ = M (m_w + m_t)/(M + m_w + m_t)", "reduction.reduced_mass", "given"),
    Equation(11, "m̃ ẍ + c ẋ + k_w x = 0", "reduction.Reduced", "reconstructed"),
    Equation(12, "x = (v₀/ω_d) e^(−ζωt) sin ω_d t", "response.displacement", "reconstructed"),
    Equation(13, "ẋ = v₀ e^(−ζωt) (cos ω_d t − ζ/√(1−ζ²) sin ω_d t)", "response.velocity", "reconstructed"),
    Equation(14, "x(τ) = 0, τ > 0", "kelvin_voigt.contact_time", "given"),
    Equation(15, "ω_d τ = π", "response.end_angle", "reconstructed"),
    Equation(16, "τ = π/ω_d", "contact_time.displacement_zero", "given"),
    Equation(17, "e = −(v_t′ − v_h′)/(v_t − v_h)", "restitution.measured", "reconstructed"),
    Equation(18, "e = exp(−πζ/√(1−ζ²))", "restitution.displacement_zero", "given"),
    Equation(19, "v_t′ = v_cm − M/(M+m) e (v_t − v_h)", "restitution.velocities_after", "reconstructed"),
)


def by_number(number: int) -> Equation:
    """The equation with a number from 1 to 19.

    Raises:
        ValueError: there is no such equation.
    """
    for equation in EQUATIONS:
        if equation.number == number:
            return equation
    raise ValueError(f"the paper's equations are numbered 1 to {len(EQUATIONS)}; given: {number!r}")
