"""Claims at one set of parameter values: a verdict, or the largest modulus among the roots."""

from __future__ import annotations

from fractions import Fraction

from gks.bounds.claimvalue import compare, compare_modulus, printed_decimal, value_of
from gks.bounds.finding import Finding, Status, Values, exact_z, leading, polynomial_in_z, undecided, witness
from gks.modes.algebraic import Root
from gks.modes.analysis import analyse
from gks.modes.numerals import text_complex, text_real
from gks.modes.verdict import Mode, ModeKind, ModesResult, Verdict
from gks.scheme.expression import Expr
from gks.scheme.model import Claim, Scheme


def hold_verdict(scheme: Scheme, claim: Claim) -> Finding:
    """`stable = true` holds if the verdict is stable, `stable = false` if it is any other that was reached."""
    values = scheme.values(dict(claim.at))
    result = analyse(scheme, values)
    if result.verdict is Verdict.UNDECIDED:
        return undecided(result.because)
    derived = f"{result.verdict.value}: {result.because}"
    evidence = {**_route(result), "because": result.because}
    if (result.verdict is Verdict.STABLE) is claim.stable:
        return Finding(Status.HOLDS, derived, None, evidence)
    said = "stable" if claim.stable else "not stable"
    shows = f"claimed to be {said}, and is {result.verdict.value}"
    return Finding(Status.FAILS, derived, witness(scheme, values, shows), evidence)


def hold_modulus(scheme: Scheme, claim: Claim, formula: Expr) -> Finding:
    """A modulus holds if it is the largest of the admissible modes, or, where none is admissible, of all roots."""
    values = scheme.values(dict(claim.at))
    result = analyse(scheme, values)
    if result.verdict is Verdict.UNDECIDED:
        return undecided(result.because)
    mode = leading(result)
    if mode is None or not result.solvable:
        derived = "z = oo" if not result.solvable else "no root at all"
        shows = f"claimed abs(z) = {claim.texts['modulus']}, and there is {derived}"
        return Finding(Status.FAILS, derived, witness(scheme, values, shows), _route(result))
    which = "no root is admissible: largest of all" if mode.kind is ModeKind.INADMISSIBLE else "largest admissible"
    derived = f"abs(z) = {text_real(mode.modulus)}"
    evidence: dict[str, object] = {**_route(result), "roots": which, "z": text_complex(mode.z), "kind": mode.kind.value}
    claimed = value_of(formula, values)
    root = exact_z(scheme, values, mode)
    if root is not None:
        evidence["z_is_a_root_of"] = polynomial_in_z(root)
    sign = _sign(claim.texts["modulus"], formula, values, mode, root)
    evidence["claimed_value"] = text_real(claimed)
    if sign is None:
        return undecided(f"{derived} agrees with the claim to {AGREEING_DIGITS} digits, and equality is not proved")
    if sign == 0:
        return Finding(Status.HOLDS, derived, None, evidence)
    shows = f"claimed abs(z) = {text_real(claimed)}, derived {text_real(mode.modulus)}"
    return Finding(Status.FAILS, derived, witness(scheme, values, shows), evidence)


def _route(result: ModesResult) -> dict[str, object]:
    return {"verdict": result.verdict.value, "tier": result.tier, "certified": result.certified}


AGREEING_DIGITS = 20
"""Digits to which modes are listed, with some to spare: numbers that agree to these are told apart by algebra alone."""


def _sign(text: str, formula: Expr, values: Values, mode: Mode, root: Root | None) -> int | None:
    """The sign of claim - modulus, 0 where the claim is right; None where only digits speak for it."""
    error = mode.radius + mode.modulus / 10**AGREEING_DIGITS
    printed = printed_decimal(text)
    if printed is not None:
        value, half = printed
        gap = value - mode.modulus
        return 0 if abs(gap) <= half else 1 if gap > 0 else -1
    gap = value_of(formula, values) - mode.modulus
    if abs(gap) > error:
        return 1 if gap > 0 else -1
    if mode.kind in (ModeKind.EIGENVALUE, ModeKind.GENERALIZED):
        return compare(formula, values, Root.of(Fraction(1)))
    return None if root is None else compare_modulus(formula, values, root)
