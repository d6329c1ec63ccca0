"""Polynomials as text that sympy reads back, and as LaTeX."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from flint import fmpz_mpoly

from gks.scheme.numbers import integer_text

GREEK = frozenset({
        "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu",
        "nu", "xi", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
})  # fmt: skip


def latex_name(name: str) -> str:
    """A symbol in LaTeX: Greek by its name, lam as lambda, what follows an underscore as an index."""
    head, _, tail = name.partition("_")
    digits = head.lstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")
    stem = head[: len(head) - len(digits)]
    tail = tail or digits if digits.isdigit() or not digits else tail
    stem = "lambda" if stem == "lam" else stem
    base = f"\\{stem}" if stem in GREEK else (stem if len(stem) == 1 else rf"\mathrm{{{stem}}}")
    return rf"{base}_{{{tail}}}" if tail else base


def polynomial_text(polynomial: fmpz_mpoly, names: Mapping[str, str], first: str) -> str:
    """Expanded, descending in the variable ``first``; ``names`` maps context variables to printed ones."""
    return _joined(polynomial, names, first, _text_factor, "*")


def polynomial_latex(polynomial: fmpz_mpoly, names: Mapping[str, str], first: str) -> str:
    """The same in LaTeX."""
    return _joined(polynomial, names, first, _latex_factor, " ")


def _text_factor(name: str, power: int) -> str:
    return name if power == 1 else f"{name}**{power}"


def _latex_factor(name: str, power: int) -> str:
    return latex_name(name) if power == 1 else f"{latex_name(name)}^{{{power}}}"


def _joined(
    polynomial: fmpz_mpoly,
    names: Mapping[str, str],
    first: str,
    factor: Callable[[str, int], str],
    times: str,
) -> str:
    variables = polynomial.context().names()
    lead = variables.index(first)
    terms = sorted(polynomial.to_dict().items(), key=lambda term: (-term[0][lead], [-p for p in term[0]]))
    text = ""
    for powers, coefficient in terms:
        value = int(coefficient)
        factors = [factor(names.get(variables[lead], variables[lead]), powers[lead])] if powers[lead] else []
        rest = [
            factor(names.get(variables[k], variables[k]), power)
            for k, power in enumerate(powers)
            if power and k != lead
        ]
        size = abs(value)
        parts = ([integer_text(size)] if size != 1 or not (factors or rest) else []) + rest + factors
        body = times.join(parts)
        if not text:
            text = f"-{body}" if value < 0 else body
        else:
            text += f" - {body}" if value < 0 else f" + {body}"
    return text or "0"
