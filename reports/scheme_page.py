"""The report of one scheme: what was found, in the order in which people ask."""

from __future__ import annotations

from collections.abc import Mapping
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
    Panel,
    Paragraph,
    Report,
    Result,
    Section,
    Strong,
    Table,
    Text,
    counted,
    shown,
    signed,
)
from gks.reports.formulas import NotAFormula, formula, name
from gks.reports.provenance import provenance
from gks.reports.scheme_answers import (
    audit_blocks,
    certificate_file,
    compared,
    curve_blocks,
    detached,
    map_blocks,
    march_blocks,
    proved,
    theorem_blocks,
)
from gks.reports.scheme_maths import scheme_section
from gks.reports.scheme_topics import Answers, Topic, fixed, values_text
from gks.scheme.model import Scheme

TONES = {"stable": "good", "neutral": "open", "generalized": "open", "unstable": "bad", "undecided": "open"}


def build(scheme: Scheme, stem: str, records: Mapping[str, Mapping[str, Any]]) -> Report:
    """The report of a scheme from the records of its steps; `stem` begins the names of its files."""
    attachments: dict[str, str] = {}
    records = {key: detached(record, certificate_file(stem), attachments) for key, record in records.items()}
    answers = Answers(scheme, stem, {key: Result(key, record) for key, record in records.items()})
    sections = [topic.section(answers) for topic in TOPICS]
    return Report(
        stem,
        scheme.title,
        _summary(answers),
        (_scheme(answers), *(section for section in sections if section is not None), provenance(records)),
        records,
        {scheme.name: scheme.text},
        attachments,
    )


def _scheme(answers: Answers) -> Section:
    """What was read, behind the picture of the grid."""
    read = scheme_section(answers.scheme)
    return Section(read.anchor, read.title, (_grid(answers.scheme, answers.stem), *read.blocks))


# At the top -----------------------------------------------------------------------------------------------------------


def _summary(answers: Answers) -> tuple[Block, ...]:
    scheme = answers.scheme
    rows: list[tuple[Text, Text]] = []
    modes, theorem, march, audit = (answers.given(step) for step in ("modes", "theorem", "march", "audit"))
    if modes is not None:
        verdict = modes.get("verdict")
        at: Text = ("at ", *values_text(modes.get("parameters")))
        rows.append((at, (Strong(verdict, TONES[verdict]), ": ", modes.quote("because"))))
    if theorem is not None:
        word = Strong("proved", "good") if proved(theorem) else Strong("not proved", "open")
        rows.append((("stable region",), (word, "; see ", Link("the theorem", "#theorem"))))
    if march is not None:
        seen: Text = (march.quote("because"),)
        if march.get("predicted") is not None and march.get("told"):
            seen = ("observed ", march.number("observed"), ", predicted ", march.number("predicted"))
        rows.append((("a march",), (compared(march), ": ", *seen)))
    if audit is not None:
        rows.append((("claims",), _tally(audit)))
    blocks: list[Block] = [Paragraph((scheme.source,))] if scheme.source else []
    return (*blocks, Table((), (("",), ("",)), tuple(rows))) if rows else tuple(blocks)


def _tally(audit: Result) -> Text:
    claims = audit.get("claims")
    counts = {word: sum(c["evidence"]["status"] == word for c in claims) for word in ("holds", "fails", "undecided")}
    parts = [f"{count} {word if count == 1 else word.removesuffix('s')}" for word, count in counts.items() if count]
    tone = "bad" if counts["fails"] else "open" if counts["undecided"] else "good"
    return (Strong(", ".join(parts), tone), "; see ", Link("the audit", "#audit"))


MOST_PLACES = 12
"""Values from the closure that the description of the grid lists."""


# Sections -------------------------------------------------------------------------------------------------------------


def _grid(scheme: Scheme, stem: str) -> Figure:
    data = Data(
        {
            "domain": [v.domain for v in scheme.boundary_unknowns],
            "unknown": [v.unknown for v in scheme.boundary_unknowns],
            "index": [v.index for v in scheme.boundary_unknowns],
        }
    )
    lines = len(scheme.domains)
    places = ", ".join(str(v) for v in scheme.boundary_unknowns[:MOST_PLACES])
    places += ", …" if len(scheme.boundary_unknowns) > MOST_PLACES else "."
    return Figure(
        f"{stem}-grid",
        ("The grid next to the boundary: cells, and the values that the closure gives.",),
        f"{'Two half-lines that meet' if lines == 2 else 'One half-line'}. Values from the closure: {places}",
        (Panel(partial(figures.draw_grid, scheme), aspect=0.22 + 0.16 * lines),),
        {"": data},
    )


def _derivation(_: Answers, derived: Result) -> list[Block]:
    text, factors = derived.get("characteristic_polynomial"), derived.get("factors")
    if not factors:
        constant = derived.quote("characteristic_polynomial")
        told: Text = ("There is no normal mode: the characteristic polynomial is the constant ", constant, ".")
        return [Paragraph(told)]
    where = "/results/derive/result/characteristic_polynomial"
    blocks: list[Block] = [
        Paragraph(("A normal mode exists where",)),
        _shown_formula(f"{text} = 0", "The characteristic polynomial", where),
    ]
    if len(factors) > 1 or any("**" in factor and factor.startswith("(") for factor in factors):
        product = "*".join(f if f.startswith("(") and f.count("(") == 1 else f"({f})" for f in factors)
        blocks.append(Paragraph(("factored,",)))
        blocks.append(_shown_formula(f"{product} = 0", "Its factors"))
    if derived.get("root_map") != "z = z":
        blocks.append(Paragraph(("and its roots become growth factors a step by",)))
        blocks.append(_shown_formula(derived.get("root_map"), "The root map"))
    return blocks


def _shown_formula(text: str, label: str, place: str = "") -> Block:
    try:
        return Formula(formula(text), label, place)
    except NotAFormula:
        return Paragraph((Code(text if len(text) < 4000 else text[:3990] + " …"),))


def _modes(answers: Answers, result: Result) -> list[Block]:
    verdict, modes = result.get("verdict"), result.get("modes")
    how = f"(tier: {result.get('tier')}{', certified' if result.get('certified') else ''})."
    head: Text = ("At ", *values_text(result.get("parameters")), ": ", Strong(verdict, TONES[verdict]), ", ")
    head = (*head, result.quote("because"), " ", how)
    blocks: list[Block] = [Paragraph(head)]
    if modes:
        blocks += [_modes_figure(answers.stem, modes), _modes_table(result)]
    return [*blocks, *_profile(answers), *_paths(answers)]


def _modes_figure(stem: str, modes: list[Mapping[str, Any]]) -> Figure:
    worst = max((m for m in modes if m["kind"] != "inadmissible"), key=_modulus, default=None)
    seen = f"{counted(len(modes), 'root')} of the characteristic polynomial around the unit circle. "
    if worst is not None:
        seen += f"The admissible one of largest modulus is {worst['kind']}, with modulus {shown(worst['modulus'])}."
    else:
        seen += "None is admissible."
    columns = {
        "re": [m["z"][0] if m["z"] != "oo" else "oo" for m in modes],
        "im": [m["z"][1] if m["z"] != "oo" else "oo" for m in modes],
        "modulus": [m["modulus"] for m in modes],
        "radius": [m["radius"] for m in modes],
        "multiplicity": [m["multiplicity"] for m in modes],
        "kind": [m["kind"] for m in modes],
    }
    caption = "Roots in the z-plane. Outside the circle a mode grows; what is inadmissible does not decay in space."
    draw = Panel(partial(figures.draw_roots, modes), aspect=0.86)
    return Figure(f"{stem}-modes", (caption,), seen, (draw,), {"": Data(columns)})


def _modulus(mode: Mapping[str, Any]) -> float:
    return float("inf") if mode["modulus"] == "oo" else float(mode["modulus"])


def _profile(answers: Answers) -> list[Block]:
    """What the worst mode looks like in space."""
    result, scheme = answers.given("profile"), answers.scheme
    if result is None or result.get("index") is None:
        return []
    data = result.record["result"]
    mode, values = data["mode"], data["shapes"][0]["values"]
    domains = sorted((d for d in scheme.domains if values[d.name]["index"]), key=lambda d: d.side != "left")
    rows = [
        (d.name, unknown, index, *value)
        for d in domains
        for unknown in d.unknowns
        for index, value in zip(values[d.name]["index"], values[d.name][unknown], strict=True)
    ]
    if not rows:
        return []
    columns = dict(zip(("domain", "unknown", "index", "re", "im"), map(list, zip(*rows, strict=True)), strict=True))
    present = [c for c in data["components"] if c["present"]]
    where = {d.name: f" in {d.name}" if len(scheme.domains) > 1 else "" for d in scheme.domains}
    factors = ", ".join(shown(c["modulus"], 4) + where[c["domain"]] for c in present[:MOST_FACTORS])
    more = ", …" if len(present) > MOST_FACTORS else "."
    modes = answers.given("modes")
    finite = "finite " if modes is not None and any(each["z"] == "oo" for each in modes.get("modes")) else ""
    one_of = f"; one of {data['dimension']} independent shapes" if data["dimension"] > 1 else ""
    figure = Figure(
        f"{answers.stem}-profile",
        (
            f"The {mode['kind']} mode of largest {finite}modulus, |z| = ",
            result.number("mode", "modulus", digits=7),
            f", in space{one_of}; its largest value is 1.",
        ),
        f"Moduli of its spatial factors: {factors}{more}" if factors else "It lives in single values at the boundary.",
        tuple(Panel(partial(figures.draw_profile, scheme, data, d.name), aspect=0.6) for d in domains),
        {"": Data(columns)},
    )
    return [figure]


def _paths(answers: Answers) -> list[Block]:
    """Where the roots move as the parameter runs."""
    result, scheme = answers.given("roots"), answers.scheme
    if result is None or not result.get("tracks"):
        return []
    data, sweep = result.record["result"], result.record["arguments"]["sweep"]
    rows = [
        (value, k, *z, kind)
        for k, track in enumerate(data["tracks"])
        for value, z, kind in zip(data["values"], track["z"], track["kind"], strict=True)
        if z is not None
    ]
    if not rows:
        return []
    columns = zip((data["sweep"], "track", "re", "im", "kind"), map(list, zip(*rows, strict=True)), strict=True)
    planes = ["z", "r"] if any(r is not None for track in data["tracks"] for r in track["r"]) else ["z"]
    first, last = shown(data["values"][0], 3), shown(data["values"][-1], 3)
    growing = sum("growing" in track["kind"] for track in data["tracks"])
    figure = Figure(
        f"{answers.stem}-roots",
        (
            "The paths of the roots as ",
            Maths(name(data["sweep"])),
            f" runs from {first} to {last}",
            *fixed(result, data["sweep"]),
            ", with arrows.",
        ),
        f"{counted(len(data['tracks']), 'path')}. Growing modes on a part of their way: {growing}.",
        tuple(Panel(partial(figures.draw_rootmap, scheme, data, sweep, plane), aspect=0.95) for plane in planes),
        {"": Data(dict(columns))},
    )
    return [figure]


MOST_ROWS = 40
"""Roots that the table lists; the data of their picture have all."""

MOST_FACTORS = 6
"""Spatial factors that the description of a mode lists."""


def _modes_table(result: Result) -> Table:
    rows = []
    modes = result.get("modes")
    for k, mode in enumerate(modes[:MOST_ROWS]):
        z: Text = ("∞",)
        if mode["z"] != "oo":
            real, imaginary = (result.number("modes", k, "z", part, digits=8) for part in (0, 1))
            z = (real, " ", signed(imaginary), "i") if imaginary.value else (real,)
        row_: tuple[Text, ...] = (
            z,
            (result.number("modes", k, "modulus", digits=10),),
            (result.number("modes", k, "multiplicity"),),
            (mode["kind"],),
        )
        rows.append(row_)
    columns: tuple[Text, ...] = ((Maths(name("z")),), ("|z|",), ("multiplicity",), ("kind",))
    which = "The roots" if len(modes) <= MOST_ROWS else f"The first {MOST_ROWS} of {len(modes)} roots"
    return Table((f"{which}, each as a double.",), columns, tuple(rows), frozenset({0, 1, 2}))


TOPICS = (
    Topic("derive", "polynomial", "Characteristic polynomial and root map", "Not derived", _derivation),
    Topic("modes", "modes", "Normal modes", "Not analysed", _modes),
    Topic("curve", "curve", "Largest stable CFL number", "No curve", curve_blocks),
    Topic("radius", "map", "Spectral radius of the modes", "No map", map_blocks),
    Topic("theorem", "theorem", "Theorem", "Not proved", theorem_blocks),
    Topic("march", "march", "Predicted against observed growth", "No march", march_blocks),
    Topic("audit", "audit", "Claims, held against what is derived", "No audit", audit_blocks),
)
"""The sections between what was read and what was run, in their order."""
