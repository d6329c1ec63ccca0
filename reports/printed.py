"""What Banks & Sjögreen print, with its place in the paper, to be laid beside what is derived.

Nothing here enters a computation. Formulas are in the paper's own letters, where rho_L/rho_R is its density ratio.
"""

from __future__ import annotations

from dataclasses import dataclass

TITLE = "A Normal Mode Stability Analysis of Numerical Interface Conditions for Fluid/Structure Interaction"


@dataclass(frozen=True, slots=True)
class PrintedTheorem:
    """A theorem as printed: its number, the shipped scheme that it is about, the bound, and what else it says."""

    number: str
    scheme: str
    about: str
    bound: str
    note: str


THEOREMS = (
    PrintedTheorem(
        "3.1", "traditional-1", "traditional coupling (3.6), first order, explicit",
        "lambda < min(1, 4/(1 + rho_L/rho_R))",
        "The roots that its proof arrives at, r = 1/2 ± (i/2) $sqrt(kappa_L/kappa_R)$, are not those of the "
        "determinant printed above them, which has $kappa_R/kappa_L$; with its own the bound holds in $rho_R/rho_L$.",
    ),
    PrintedTheorem(
        "3.2", "implicit-1", "traditional coupling (3.12), first order, implicit", "0 < lambda",
        "As printed. Its proof has slips that do no harm: (3.13) has 4 + 2λ in the denominator of its second form "
        "where multiplying out gives 4 + 4λ, and again $kappa_L/kappa_R$ for $kappa_R/kappa_L$.",
    ),
    PrintedTheorem(
        "3.3", "weighted-1", "impedance-weighted coupling (3.19), first order", "0 < lambda <= 1",
        "As printed. The remark after it, for unequal speeds, has z = 1 − $lambda_L$ or 1 − $lambda_R$, where r = 1/2 "
        "gives 1 − $lambda_L/2$ or 1 − $lambda_R/2$; the conclusion stands.",
    ),
    PrintedTheorem(
        "3.4", "traditional-2", "traditional coupling (3.23), second order",
        "lambda < min(1, 3/2 - sqrt(2)/4*sqrt("
        "(-7 + 2*alpha + 9*alpha**2 + sqrt((49 + 81*alpha)*(alpha + 1)**3))/(alpha + 1)**2))",
        "The printed formula is right for $alpha = rho_R/rho_L$; the paper says $alpha = rho_L/rho_R$. The proof's "
        "last line has β where $beta**2 = kappa_R/kappa_L$ belongs. $(-8 + 2*sqrt(17))/2 = sqrt(17) - 4$ is right.",
    ),
    PrintedTheorem(
        "3.5", "weighted-2", "impedance-weighted coupling (3.30), second order", "0 < lambda <= 1", "As printed.",
    ),
)  # fmt: skip

UNEQUAL = ("weighted-1-unequal", "weighted-2-unequal")
"""Schemes of the remarks after Theorems 3.3 and 3.5."""

OTHERS = ("traditional-1-mirror", "average-1", "characteristic-1", "characteristic-2")
"""Schemes about which Sections 2 and 3.3 say something without a theorem."""


@dataclass(frozen=True, slots=True)
class PrintedNumber:
    """A number in the text: where, what of, and its digits as printed."""

    key: str
    where: str
    what: str
    digits: str


NUMBERS = (
    PrintedNumber("fig5-unstable", "Section 4, Fig. 5", "modulus at the ratio 4/λ − 1 + 0.01", "1.001012"),
    PrintedNumber("fig5-stable", "Section 4, Fig. 5", "modulus at the ratio 4/λ − 1 − 0.01", "0.9989870"),
    PrintedNumber("neutral-2", "Section 4, Fig. 8", "neutral ratio of the second-order condition at λ = 0.9", "0.1876"),
    PrintedNumber("fig8-unstable", "Section 4, Fig. 8", "modulus at 0.1876 + 0.01, the unstable case", "0.9893"),
    PrintedNumber("fig8-stable", "Section 4, Fig. 8", "modulus at 0.1876 − 0.01, the stable case", "1.0104"),
    PrintedNumber("lam-at-1", "Section 3.4", "largest λ at equal densities, second order", "0.4397"),
    PrintedNumber("full-range", "Theorem 3.4", "ratio up to which λ < 1 is stable", "0.123"),
    PrintedNumber("restricted", "Section 3.4", "ratio from which either side is restricted", "0.1231"),
    PrintedNumber("restricted-up", "Section 3.4", "ratio up to which either side is restricted", "8.123"),
    PrintedNumber("rate", "Section 4, Fig. 9", "convergence rate over the last doubling, weighted", "1.99"),
)

SLIPS = (
    ("Section 3, the flux", "RΛR⁻¹ as printed is minus the matrix that stands before it: it is the Jacobian of the "
     "flux, which (3.1) splits correctly."),
    ("(3.20a)", "the stress of the left side next to the interface has the index 1 where (3.19) has 0."),
    ("(3.24b)", "the velocity term has the sign of (3.24a); (3.7b) has a minus there. (3.25) and (3.26) are right."),
    ("Section 3.4", "the bound at equal densities is ascribed to Theorem 3.5; it is about Theorem 3.4's scheme."),
    ("Section 4, the exact solution", "three slips: f(−ct) for f(x − ct) ahead of the wave, which would not depend on "
     "x; +2f for −2f in the reflected velocity, so that u would jump at the interface; and the pulse centred at +1/2, "
     "from where it never meets the interface. From −1/2 it arrives at t = 0.289, as the account of Fig. 4 has it."),
    ("(2.4a)", "the fluid's velocity stands in the solid's ghost; then (2.5) would not be the mean of (2.3) and (2.4). "
     "With the solid's own velocity it is."),
    ("(4.3a)", "the velocity weights are those of the stress; (3.19) has them crosswise, as impedance weights go."),
    ("Section 2, the grid", "a unit length has both N − 1 and N + 1 points; Δx = 1/(N − 1) and 1/N give one table."),
)  # fmt: skip
"""Places where the text contradicts itself, and what was taken instead."""
