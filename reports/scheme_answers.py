"""The answers in a scheme's report: the stable-CFL curve, the theorem, the march, the audit."""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from functools import partial
from typing import Any

from gks.reports import scheme_figures as figures
from gks.reports.document import (
    Block,
    Code,
    Data,
    Figure,
    Formula,
    Link,
    Maths,
    Number,
    Panel,
    Paragraph,
    Result,
    Strong,
    Table,
    Text,
    counted,
    shown,
)
from gks.reports.formulas import Node, NotAFormula, cases, formula, laid_out, name, operator, relation, row, words
from gks.reports.scheme_plan import sweep_of, swept
from gks.reports.scheme_topics import Answers, fixed, values_text
from gks.reports.store import digest
from gks.scheme.model import Scheme


def curve_blocks(answers: Answers, result: Result) -> list[Block]:
    """The stable-CFL curve over the scheme's parameter, or the stable set where it has none."""
    scheme = answers.scheme
    points, parameter = result.get("points"), swept(scheme)
    resolved = sum(point["status"] == "resolved" for point in points)
    theorem = answers.given("theorem")
    stands = theorem is not None and proved(theorem)
    status = "proved for the whole range below" if stands else f"{resolved} of {counted(len(points), 'point')} resolved"
    sweep = sweep_of(scheme)
    seen = _curve_words(points, parameter.name if parameter else None)
    columns = {
        **({parameter.name: [p[parameter.name] for p in points]} if parameter else {}),
        "lam_max": ["inf" if p["lam_max"] == "oo" else p["lam_max"] for p in points],
        "limited_by": [p["limited_by"] for p in points],
        "stable_set": ["; ".join(f"({low}, {high})" for low, high in p["stable_set"]) for p in points],
        "error_bound": [p["error_bound"] for p in points],
    }
    data = dict(result.record["result"])
    figure = Figure(
        f"{answers.stem}-curve",
        (
            "The stable CFL numbers (shaded) and the largest, below which all are stable",
            *fixed(result, scheme.cfl, parameter.name if parameter else ""),
            f" ({status}).",
        ),
        seen,
        (Panel(partial(figures.draw_bound, scheme, data, sweep), aspect=0.68 if parameter else 0.4),),
        {"": Data(columns)},
    )
    return [figure, _curve_table(scheme, result)]


def map_blocks(answers: Answers, result: Result) -> list[Block]:
    """The largest modulus of an admissible mode over the parameter and lam, with the bound on it."""
    data = result.record["result"]
    curve = answers.given("curve")
    bound = None if curve is None else curve.record["result"]
    sweep = data["sweep"].partition("=")[0] if data["sweep"] else None
    cells = [
        (value, lam, data["radius"][i][k] if data["known"][i][k] and data["interior"][i][k] else None)
        for i, value in enumerate(data["values"])
        for k, lam in enumerate(data["lams"])
    ]
    known = [radius for _, _, radius in cells if radius is not None]
    if not any(known):  # no mode is admissible where the modulus is known
        return []
    growing = sum(radius > 1 for radius in known)
    seen = f"{len(known)} of {len(cells)} points have a modulus. Above 1: {growing} of them; the largest is "
    seen += f"{shown(max(known), 4)}."
    caption = "; 0 where no mode is admissible."
    if sweep and not all(map(all, data["interior"])):
        caption += " Hatched: the interior scheme is unstable by itself."
    if sweep and bound is not None:
        caption += " Dashed: the largest stable CFL number."
    held = fixed(result, answers.scheme.cfl, sweep or "")
    columns = {**({sweep: [v for v, _, _ in cells]} if sweep else {}), "lam": [lam for _, lam, _ in cells]}
    columns["radius"] = [radius for _, _, radius in cells]
    figure = Figure(
        f"{answers.stem}-map",
        ("The largest modulus of an admissible mode", *held, caption),
        seen,
        (Panel(partial(figures.draw_radius, answers.scheme, data, bound), aspect=0.8 if sweep else 0.6),),
        {"": Data(columns)},
    )
    return [figure]


def _curve_words(points: list[Mapping[str, Any]], parameter: str | None) -> str:
    known = [p for p in points if p["status"] == "resolved"]
    if not known:
        return "Undecided." if parameter is None else "No point is resolved."
    if parameter is None:
        return f"The largest stable CFL number is {shown(known[0]['lam_max'])}."
    first, last = known[0], known[-1]
    return (
        f"From {shown(first['lam_max'])} at {parameter} = {shown(first[parameter], 3)} to {shown(last['lam_max'])} at "
        f"{parameter} = {shown(last[parameter], 3)}. Limited by the closure: "
        f"{sum(p['limited_by'] == 'closure' for p in known)} of {len(points)} points."
    )


TABLE_POINTS = 9


def _curve_table(scheme: Scheme, result: Result) -> Table:
    points, parameter = result.get("points"), swept(scheme)
    chosen = sorted({round(k * (len(points) - 1) / (TABLE_POINTS - 1)) for k in range(TABLE_POINTS)})
    lam = Maths(row(name(scheme.cfl + "_max")))
    rows = []
    for k in chosen:
        cells: list[Text] = [(result.number("points", k, parameter.name, digits=4),)] if parameter else []
        top: Text = ("undecided",)
        if points[k]["lam_max"] is not None:
            top = (result.number("points", k, "lam_max", digits=10),)
        by = points[k]["limited_by"] or "–"
        rows.append((*cells, top, (by,), (result.number("points", k, "error_bound", digits=2),)))
    head: tuple[Text, ...] = ((Maths(name(parameter.name)),),) if parameter else ()
    columns: tuple[Text, ...] = (*head, (lam,), ("limited by",), ("error bound",))
    numeric = frozenset({0, 1, 3}) if parameter else frozenset({0, 2})
    caption = "Some of its points." if parameter else "In numbers."
    return Table((caption,), columns, tuple(rows), numeric)


def detached(record: Mapping[str, Any], file: str, attachments: dict[str, str]) -> Mapping[str, Any]:
    """The record with its certificate, if it has one, in a file of its own and its digest in its place."""
    result = record.get("result")
    if not isinstance(result, Mapping) or result.get("schema") != "gks.theorem/1" or not result.get("certificate"):
        return record
    certificate = result["certificate"]
    attachments[file] = json.dumps(certificate, indent=1) + "\n"
    return {**record, "result": {**result, "certificate": {"file": file, "sha256": digest(certificate)}}}


def theorem_blocks(answers: Answers, result: Result) -> list[Block]:
    """The theorem, piece by piece, with the name of its certificate."""
    if not proved(result):
        return [Paragraph(unproved(result))]
    parameter = result.get("parameter")
    rows, tails = stated(result.get("statement"))
    certificate = certificate_file(answers.stem)
    held = values_text(result.record["arguments"]["values"])
    return [
        Paragraph(("With ", *held, ": ", Strong("stable exactly for")) if held else (Strong("Stable exactly for"),)),
        Formula(cases(rows), "The stable region"),
        *map(Paragraph, tails),
        _pieces_table(result, parameter),
        Paragraph(
            (
                Strong("Proved", "good"),
                "; the certificate ",
                Link(certificate, certificate),
                " was ",
                Strong("accepted", "good"),
                " by code that the prover does not share (",
                Code(f"gks check {certificate}"),
                ").",
            )
        ),
    ]


def proved(theorem: Result) -> bool:
    """Whether a theorem stands: proved, and its certificate accepted."""
    return theorem.get("status") == "proved" and bool(theorem.get("checked", "accepted"))


def unproved(theorem: Result) -> Text:
    """Why a theorem does not stand."""
    if theorem.get("status") != "proved":
        return (Strong("Not proved", "open"), f": {theorem.get('reason')}.")
    problem = theorem.get("checked", "problem")
    return (
        Strong("Not proved", "bad"),
        f": the certificate was rejected by code that the prover does not share: {problem}.",
    )


def certificate_file(stem: str) -> str:
    """The name of the file with a theorem's certificate."""
    return f"{stem}-certificate.json"


def stated(statement: str) -> tuple[list[tuple[Node, Node]], list[Text]]:
    """The lines of a theorem's statement as (where stable, for which parameter), and what it says besides."""
    rows: list[tuple[Node, Node]] = []
    tails: list[Text] = []
    for line in statement.partition(": stable exactly for\n")[2].splitlines():  # a title may have lines of its own
        text = line.strip().partition("; ")[0]
        if text.startswith("the bound"):
            tails.append(_tail(text))
            continue
        what, _, where = text.partition(" if ")
        spans: list[Node] = []
        for span in what.strip().split(" or "):
            never = span.startswith("no ")
            node = row(words("no "), name(span.removeprefix("no "))) if never else laid_out(span)
            spans += [words(" or "), node] if spans else [node]
        condition = [words("if "), laid_out(where)] if where else []
        rows.append((row(*spans), row(*condition) if condition else words("")))
    return rows, tails


def _tail(text: str) -> Text:
    """`the bound ~ 4/alpha as alpha -> oo` as mathematics."""
    what, _, where = text.removeprefix("the bound ").partition(" as ")
    parameter, _, end = where.partition(" -> ")
    limit = laid_out(end.removeprefix("-"))
    goal = [operator("−"), limit] if end.startswith("-") else [limit]
    sign, _, value = what.partition(" ")
    signs = {"~": "∼", "->": "→"}
    bound = row(operator(signs.get(sign, sign)), laid_out(value))
    return ("The bound ", Maths(bound), " as ", Maths(row(laid_out(parameter), operator("→"), *goal)), ".")


def _pieces_table(result: Result, parameter: str | None) -> Table:
    rows = []
    for k, piece in enumerate(result.get("pieces")):
        ends: list[Text] = []
        if parameter is not None:
            ends = [_end(result, k, "from"), _end(result, k, "to")]
        closed = "yes" if piece["closed_form"] else "no"
        rows.append((*ends, (Maths(laid_out(piece["bound"])),), _on_bound(piece, parameter), (closed,)))
    head: tuple[Text, ...] = (("from",), ("to",)) if parameter is not None else ()
    columns: tuple[Text, ...] = (*head, ("largest stable",), ("on the bound",), ("closed form",))
    where: Text = ("Piece by piece, over ", Maths(name(parameter)), ".") if parameter is not None else ("The bound.",)
    return Table(where, columns, tuple(rows))


def _on_bound(piece: Mapping[str, Any], parameter: str | None) -> Text:
    """The verdict at lam = bound with what it allows for, and where it is another one."""
    text: Text = ((piece["at_bound"] or "–") + piece["reserve"],)
    for value, verdict in piece.get("at_bound_except", ()):
        assert parameter is not None
        text = (*text, f", {verdict} at ", Maths(relation(name(parameter), "=", laid_out(value))))
    return text


def _end(result: Result, k: int, which: str) -> Text:
    text = result.get("pieces", k, which)
    value: Number = result.number("pieces", k, f"{which}_value")
    exact = Maths(laid_out(text))
    if text.replace("-", "−") == value.text or text in ("oo", "-oo"):
        return (value,)
    return (exact, " = " if _is_all_of(value, text) else " ≈ ", value)


def _is_all_of(value: Number, exact: str) -> bool:
    """Whether a number as it is shown is the exact one: 0.5 for 1/2, not 0.333333 for 1/3."""
    try:
        return Fraction(exact) == Fraction(f"{value.value:.6g}")
    except ValueError:  # a root, or a number beyond doubles
        return False


def march_blocks(answers: Answers, result: Result) -> list[Block]:
    """Predicted against observed growth, with the history of a march."""
    data = result.record["result"]
    rows: list[tuple[Text, Text]] = [
        (("predicted growth a step",), (result.number("predicted", digits=10),) if data["predicted"] is not None
         else ("no admissible mode: nothing is claimed",)),
        (("observed",), (result.number("observed", digits=10), " ± ", result.number("uncertainty", digits=2),
                         f" (99 %, {data['method']})")),
        (("comparison",), (compared(result), ": ", result.quote("because"))),
        (("cells and steps",), (" and ".join(map(str, data["cells"])) + f" cells, {counted(data['steps'], 'step')}",)),
    ]  # fmt: skip
    seen = f"The size after up to {counted(data['steps'], 'step')}; growth a step observed {shown(data['observed'])}"
    seen += f", predicted {shown(data['predicted'])}." if data["predicted"] is not None else ", no mode predicted."
    figure = Figure(
        f"{answers.stem}-march",
        (f"Marched ({data['method']}): the size next to the boundary after every step.",),
        seen,
        (Panel(partial(figures.draw_history, data), aspect=0.6),),
        {
            f"-{k + 1}" if k else "": Data({"step": each["steps"], "log10_size": each["log10_size"]})
            for k, each in enumerate(data["histories"])
        },
    )
    return [figure, Table((), (("",), ("",)), tuple(rows))]


def compared(march: Result) -> Strong:
    """Whether a march bears the modes out: only where it could have done otherwise does it agree."""
    if not march.get("agrees"):
        return Strong("disagrees", "bad")
    return Strong("agrees", "good") if march.get("told") else Strong("not contradicted", "open")


def audit_blocks(_: Answers, result: Result) -> list[Block]:
    """What publications state of the scheme, against what was derived."""
    columns: tuple[Text, ...] = (("",), ("source",), ("claimed",), ("derived",))
    return [Table((), columns, tuple(claim_rows(result)))]


def claim_rows(result: Result) -> list[tuple[Text, ...]]:
    """A row a claim: its status, its source, what it says, what is derived and where that shows."""
    tones = {"holds": "good", "fails": "bad", "undecided": "open"}
    rows: list[tuple[Text, ...]] = []
    for k, claim in enumerate(result.get("claims")):
        status, claimed = claim["evidence"]["status"], claim["evidence"]["claimed"]
        derived: Text = (result.quote("claims", k, "derived"),)
        if claim["counterexample"] is not None:
            derived = (*derived, ". ", *_shown_at(result, k))
        rows.append(((Strong(status, tones[status]),), (claim["source"],), _claimed(claimed), derived))
    return rows


def _claimed(text: str) -> Text:
    """A claim's statement, with its bound as mathematics where it has one."""
    bound, _, at = text.removeprefix("bound ").partition(" at ")
    if not text.startswith("bound "):
        return (text,)
    try:
        shown_bound = Maths(formula(bound))
    except NotAFormula:
        return (Code(text),)
    return ("bound ", shown_bound, f" at {at}" if at else "")


def _shown_at(result: Result, k: int) -> Text:
    """The counterexample of a claim: exact values, what the modes say there, and what a march says."""
    example = result.get("claims", k, "counterexample")
    values = ", ".join(f"{key} = {value}" for key, value in example["parameters"].items())
    text: Text = (f"Shown at {values}: {example['verdict']}",)
    if example["modulus"] is not None:
        text = (*text, ", |z| = ", result.number("claims", k, "counterexample", "modulus", digits=7))
    march = result.get("claims", k, "evidence").get("march", {})
    if "observed" in march:
        observed = result.number("claims", k, "evidence", "march", "observed", digits=7)
        text = (*text, "; growth a step observed in a march: ", observed)
    return (*text, ".")
