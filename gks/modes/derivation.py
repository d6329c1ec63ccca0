"""The characteristic polynomial of a scheme and the map from its roots to z, with parameters as symbols."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm, log10

from flint import fmpz_mpoly

from gks.errors import NotAnalysable
from gks.modes.coefficients import Coefficients, Ratio
from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem
from gks.modes.polynomial import Degenerate, Factor, characteristic_factors
from gks.modes.printing import latex_name, polynomial_latex, polynomial_text
from gks.modes.resolvent import Resolvent
from gks.scheme.integrators import Integrator
from gks.scheme.limits import MAX_DIGITS
from gks.scheme.model import Scheme
from gks.scheme.numbers import integer_text

SAMPLE = Fraction(1)
"""Stands for a symbol without a default wherever a sign or a branch has to be chosen."""


@dataclass(frozen=True, slots=True)
class Derivation:
    """The characteristic polynomial, its irreducible factors, and how its roots become z.

    ``variable`` is r (1/kappa of the decaying solutions, where all fields share one), s or z. All formulas are text
    that sympy reads; ``latex`` has the same in LaTeX.
    """

    scheme: Scheme
    variable: str
    characteristic_polynomial: str
    factors: tuple[str, ...]
    root_map: str
    latex: Mapping[str, str]

    def to_json(self) -> dict[str, object]:
        return {
            "schema": "gks.derive/1",
            "variable": self.variable,
            "characteristic_polynomial": self.characteristic_polynomial,
            "factors": list(self.factors),
            "root_map": self.root_map,
            "latex": dict(self.latex),
        }

    def __str__(self) -> str:
        if not self.factors:
            return f"{self.scheme.title}\n  no normal modes: the determinant vanishes nowhere"
        lines = [self.scheme.title, f"  {self.characteristic_polynomial} = 0"]
        if len(self.factors) > 1 or any("**" in f and f.startswith("(") for f in self.factors):
            lines.append(f"  factors: {', '.join(self.factors)}")
        return "\n".join([*lines, f"  {self.root_map}"])

    def _repr_latex_(self) -> str:
        return rf"${self.latex['characteristic_polynomial']} = 0, \qquad {self.latex['root_map']}$"


def derive(scheme: Scheme, values: Mapping[str, Fraction]) -> Derivation:
    """Derives the polynomial; parameters that are not in ``values`` stay symbols.

    Raises NotAnalysable where the determinant vanishes identically or the elimination is out of reach.
    """
    symbols = tuple(p.name for p in scheme.parameters if p.name not in values)
    sample = {p.name: values.get(p.name, p.default if p.default is not None else SAMPLE) for p in scheme.parameters}
    problem = normal_mode_problem(scheme, sample, symbols)
    try:
        factors = characteristic_factors(problem).factors
    except Degenerate:
        raise NotAnalysable("the determinant vanishes identically: the closure is degenerate", path="closure") from None
    return _derivation(problem, factors)


def _require_printable(polynomial: fmpz_mpoly) -> None:
    """NotAnalysable for coefficients of more digits than a number that is read may have."""
    longest = max((abs(int(c)).bit_length() for c in polynomial.coeffs()), default=0) * log10(2)
    if longest > MAX_DIGITS:
        found = f"the characteristic polynomial has coefficients of {int(longest)} digits"
        raise NotAnalysable(found, expected=f"{MAX_DIGITS} are the most that are printed", mend="take shorter numbers")


def _derivation(problem: NormalModeProblem, factors: Sequence[Factor]) -> Derivation:
    coefficients, resolvent = problem.coefficients, problem.resolvent
    names = {coefficients.variable(p.name): p.name for p in problem.scheme.parameters}
    taken = {p.name for p in problem.scheme.parameters}
    method = resolvent.integrator
    if method is None:
        letter, variable = "z", _free("z", taken)
        mapped = list(factors)
        text, latex = f"z = {variable}", f"z = {latex_name(variable)}"
    else:
        speed = common_speed(problem)
        if speed is not None:
            letter, variable = "x", _free("r", taken)
            mapped = [
                _substituted(f, coefficients, speed * (_gen(coefficients, "x") - _one(coefficients)), "x")
                for f in factors
            ]
            argument = _shift(speed, variable, names, coefficients)
            text, latex = root_map(method, problem.scheme.cfl, *argument)
        elif method.kind == "multistep":
            letter, variable = "z", _free("z", taken)
            mapped = [_substituted(f, coefficients, _inverse(method, coefficients, resolvent), "z") for f in factors]
            text, latex = f"z = {variable}", f"z = {latex_name(variable)}"
        else:
            letter, variable = "s", _free("s", taken)
            mapped = list(factors)
            text, latex = root_map(method, problem.scheme.cfl, variable, latex_name(variable))
    names[letter] = variable
    product = coefficients.context.constant(1)
    for factor in mapped:
        product *= factor.polynomial**factor.multiplicity
    _require_printable(product)
    texts = tuple(_power(polynomial_text(f.polynomial, names, letter), f.multiplicity) for f in mapped)
    return Derivation(
        problem.scheme,
        variable,
        polynomial_text(product, names, letter),
        texts,
        text,
        {
            "characteristic_polynomial": polynomial_latex(product, names, letter),
            "factors": r" \cdot ".join(
                rf"\left({polynomial_latex(f.polynomial, names, letter)}\right)"
                + (f"^{{{f.multiplicity}}}" if f.multiplicity > 1 else "")
                for f in mapped
            ),
            "root_map": latex,
        },
    )


def _free(name: str, taken: set[str]) -> str:
    """The customary letter, or one like it where a parameter has that name."""
    while name in taken:
        name += "_"
    return name


def _power(text: str, multiplicity: int) -> str:
    return text if multiplicity == 1 else f"({text})**{multiplicity}"


def _gen(coefficients: Coefficients, name: str) -> Ratio:
    return coefficients.of(coefficients.gens[name])


def _one(coefficients: Coefficients) -> Ratio:
    return coefficients.number(Fraction(1))


def common_speed(problem: NormalModeProblem) -> Ratio | None:
    """c where every decaying solution is r**(-n) with s = c (r - 1): first-order upwinding at one speed."""
    coefficients = problem.coefficients
    speeds = []
    for family in problem.families:
        if not family.decaying:
            continue
        powers = powers_of(family.polynomial, "x")
        if len(powers) != 2:
            return None
        slope = powers_of(powers[1], "s")
        if len(slope) != 2 or len(powers_of(powers[0], "s")) != 1:
            return None
        speed = Ratio.make(slope[0], slope[1])
        if not coefficients.is_zero((speed + Ratio.make(powers[0], slope[1])).num):
            return None
        speeds.append(speed)
    if not speeds or any(not coefficients.is_zero((s - speeds[0]).num) for s in speeds[1:]):
        return None
    return speeds[0]


def _substituted(factor: Factor, coefficients: Coefficients, value: Ratio, variable: str) -> Factor:
    """The factor with s replaced, cleared of denominators and of what no longer holds the variable."""
    total = coefficients.context.constant(0)
    parts = powers_of(factor.polynomial, "s")
    for k, part in enumerate(parts):
        total += part * value.num**k * value.den ** (len(parts) - 1 - k)
    total = coefficients.norm(total)
    content = coefficients.context.constant(0)
    for part in powers_of(total, variable):
        content = content.gcd(part)
    total = total / content
    _, total = total.primitive()
    return Factor(-total if total.leading_coefficient() < 0 else total, factor.multiplicity)


def _inverse(method: Integrator, coefficients: Coefficients, resolvent: Resolvent) -> Ratio:
    """s = rho(z) / (lam sigma(z))."""
    z = _gen(coefficients, "z")
    rho = coefficients.add([coefficients.number(c) * coefficients.power(z, k) for k, c in enumerate(method.rho)])
    sigma = coefficients.add([coefficients.number(c) * coefficients.power(z, k) for k, c in enumerate(method.sigma)])
    return rho / (coefficients.symbol(resolvent.cfl) * sigma)


def _shift(speed: Ratio, variable: str, names: Mapping[str, str], coefficients: Coefficients) -> tuple[str, str]:
    """c (r - 1) as text and LaTeX; an irrational speed is called c."""
    text, latex = f"({variable} - 1)", rf"\left({latex_name(variable)} - 1\right)"
    if speed.num.is_one() and speed.den.is_one():
        return text, latex
    generators = {g.name: g for g in coefficients.generators}
    if any(speed.num.degrees()[coefficients.context.names().index(n)] for n in generators):
        return f"c*{text}", f"c {latex}"
    num, den = polynomial_text(speed.num, names, "x"), polynomial_text(speed.den, names, "x")
    factor = f"({num})" if " " in num else num
    over = "" if speed.den.is_one() else (f"/({den})" if " " in den or "*" in den else f"/{den}")
    tex = polynomial_latex(speed.num, names, "x")
    if not speed.den.is_one():
        tex = rf"\frac{{{tex}}}{{{polynomial_latex(speed.den, names, 'x')}}}"
    elif " " in num:
        tex = rf"\left({tex}\right)"
    return f"{factor}{over}*{text}", f"{tex} {latex}"


def root_map(method: Integrator, cfl: str, text: str, latex: str) -> tuple[str, str]:
    """z as a function of lam*s, or the polynomial that ties them, as text and LaTeX; ``text`` is s."""
    mu, tex = f"{cfl}*{text}", f"{latex_name(cfl)} {latex}"
    if method.kind == "exact":
        return f"z = exp({mu})", rf"z = e^{{{tex}}}"
    if method.kind == "runge-kutta":
        return f"z = {_series(method.stability, mu)}", f"z = {_series_latex(method.stability, tex)}"
    if len(method.rho) == 2:
        top = _series((-method.rho[0], method.sigma[0]), mu)
        top_latex = _series_latex((-method.rho[0], method.sigma[0]), tex)
        if len(method.sigma) == 1:
            return f"z = {top}", f"z = {top_latex}"
        bottom = _series((method.rho[1], -method.sigma[1]), mu)
        bottom_latex = _series_latex((method.rho[1], -method.sigma[1]), tex)
        over = f"({top})" if " " in top else top
        return f"z = {over}/({bottom})", rf"z = \frac{{{top_latex}}}{{{bottom_latex}}}"
    clear = lcm(*(c.denominator for c in (*method.rho, *method.sigma)))
    terms, terms_latex = [], []
    for k in range(len(method.rho) - 1, -1, -1):
        sigma = method.sigma[k] if k < len(method.sigma) else Fraction(0)
        for value, unit, unit_latex in ((method.rho[k], "", ""), (-sigma, mu, tex)):
            if value:
                terms.append((int(value * clear), [p for p in (unit, _z(k, "**")) if p]))
                terms_latex.append((int(value * clear), [p for p in (unit_latex, _z(k, "^")) if p]))
    return f"{_sum(terms, '*')} = 0", f"{_sum(terms_latex, ' ')} = 0"


def _z(power: int, sign: str) -> str:
    return "" if power == 0 else "z" if power == 1 else f"z{sign}{power}"


def _sum(terms: Sequence[tuple[int, list[str]]], times: str) -> str:
    text = ""
    for value, parts in terms:
        size = [integer_text(abs(value))] if abs(value) != 1 or not parts else []
        body = times.join(size + parts)
        text = (f"-{body}" if value < 0 else body) if not text else f"{text} {'-' if value < 0 else '+'} {body}"
    return text


def _series(coefficients: Sequence[Fraction], mu: str) -> str:
    terms = []
    for k, c in enumerate(coefficients):
        if not c:
            continue
        body = mu if k == 1 else f"({mu})**{k}"
        if k == 0:
            terms.append((c < 0, str(abs(c))))
        else:
            scaled = body if abs(c.numerator) == 1 else f"{abs(c.numerator)}*{body}"
            terms.append((c < 0, scaled if c.denominator == 1 else f"{scaled}/{c.denominator}"))
    return _signed(terms)


def _series_latex(coefficients: Sequence[Fraction], mu: str) -> str:
    terms = []
    for k, c in enumerate(coefficients):
        if not c:
            continue
        size = abs(c)
        number = str(size.numerator) if size.denominator == 1 else rf"\frac{{{size.numerator}}}{{{size.denominator}}}"
        body = mu if k == 1 else rf"\left({mu}\right)^{{{k}}}"
        terms.append((c < 0, number if k == 0 else body if size == 1 else f"{number} {body}"))
    return _signed(terms)


def _signed(terms: Sequence[tuple[bool, str]]) -> str:
    text = ""
    for negative, body in terms:
        text = (f"-{body}" if negative else body) if not text else f"{text} {'-' if negative else '+'} {body}"
    return text or "0"


