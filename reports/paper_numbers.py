"""The numbers in the paper's text beside what is found, the differences explained, and error against run time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from decimal import Decimal
from functools import partial

from gks.reports import paper_figures as figures
from gks.reports.document import (
    Block,
    Data,
    Figure,
    Listing,
    Number,
    Panel,
    Paragraph,
    Result,
    Seconds,
    Section,
    Strong,
    Table,
    Text,
    prose,
    shown,
)
from gks.reports.paper_experiments import missing
from gks.reports.printed import NUMBERS, SLIPS, PrintedNumber
from gks.reports.scheme_answers import proved

Results = Mapping[str, Result]

Found = Callable[[Results], Number]


def _at(name: str, *path: str | int, digits: int = 8) -> tuple[str, Found]:
    return name, lambda results: results[name].number(*path, digits=digits)


FOUND: Mapping[str, tuple[str, Found]] = {
    "fig5-unstable": _at("figure-5", "lines", 0, "predicted"),
    "fig5-stable": _at("figure-5", "lines", 1, "predicted"),
    "neutral-2": _at("neutral", "neutral", "traditional-2"),
    "fig8-unstable": _at("figure-8-traditional", "lines", 0, "predicted"),
    "fig8-stable": _at("figure-8-traditional", "lines", 1, "predicted"),
    "lam-at-1": _at("neutral", "lam_max_at_1"),
    "full-range": _at("theorem-traditional-2", "pieces", 0, "to_value"),
    "restricted": _at("neutral", "full_range"),
    "restricted-up": _at("neutral", "full_range_mirrored"),
    "rate": _at("convergence-weighted", "rates", -1, digits=5),
}
"""Where each printed number has its counterpart."""


def numbers_section(results: Results) -> Section:
    """Every number of Section 4's text, and those of Section 3.4."""
    rows = [_number_row(printed, results) for printed in NUMBERS]
    columns: tuple[Text, ...] = (("where",), ("what",), ("printed",), ("found",), ("",))
    blocks: list[Block] = [Table(("Numbers in the text.",), columns, tuple(rows), frozenset({2, 3}))]
    blocks += _blow_up(results["figure-7-traditional"])
    left = results["left"]
    if left.refused is None:
        blocks.append(
            Paragraph(
                (
                    "“As expected the errors decay off to ≈ 10⁻⁶⁰ by t = 5” (weighted, fully second order): found ",
                    left.number("velocity_error", digits=3),
                    " at t = ",
                    left.number("time", digits=4),
                    ".",
                )
            )
        )
    return Section("numbers", "Numbers in the text of Sections 3.4 and 4", tuple(blocks))


def _number_row(printed: PrintedNumber, results: Results) -> tuple[Text, ...]:
    head: tuple[Text, ...] = ((printed.where,), (printed.what,), (printed.digits,))
    name, found = FOUND[printed.key]
    result = results[name]
    if result.refused is not None or (name.startswith("theorem") and not proved(result)):
        return (*head, ("–",), ("",))
    number = found(results)
    return (*head, (number,), _agreement(float(number.value), printed.digits))


def _agreement(value: float, digits: str) -> Text:
    return (Strong("as printed", "good"),) if rounds_to(value, digits) else (Strong("differs", "bad"),)


def rounds_to(value: float, digits: str) -> bool:
    """Whether a value rounds to a printed decimal at the digits printed."""
    decimal = Decimal(digits)
    exponent = decimal.as_tuple().exponent
    assert isinstance(exponent, int)
    return abs(Decimal(value) - decimal) <= Decimal(1).scaleb(exponent) / 2


LARGE = 1e8


def _blow_up(result: Result) -> list[Block]:
    """The traditional condition at the ratio 1e10: when the error passes 1e8."""
    if result.refused is not None:
        return [missing(result)]
    passed = {}
    for quantity in ("velocity", "stress"):
        errors = result.get("lines", 0, f"{quantity}_error")
        passed[quantity] = next((n for n, error in enumerate(errors) if error is None or error >= LARGE), None)
    at_two: Text = ()
    for quantity in ("velocity", "stress"):
        number = result.number("lines", 0, f"{quantity}_error", 2, digits=2)
        at_two = (*at_two, " and " if at_two else "", number, f" in {quantity}")
    return [
        Paragraph(
            (
                "“By the second step the max error is already ≈ 10⁸” (traditional, ratio 10¹⁰): at the second step the "
                "errors found are ",
                *at_two,
                f"; 10⁸ is passed at step {passed['stress']} in stress and at step {passed['velocity']} in velocity.",
            )
        )
    ]


# Differences ----------------------------------------------------------------------------------------------------------


def differences_section(results: Results) -> Section:
    """What differs from print, and why."""
    swapped: Text = ("Fig. 8's moduli are printed in the wrong order: the unstable ratio has the larger one.",)
    inverted: Text = (
        Strong("The ratio is inverted. "),
        *prose("The paper states its bounds in $rho_L/rho_R$. Its own determinants, those of (3.8) and (3.26), hold "),
        *prose("$kappa_R/kappa_L$, at equal speeds $rho_R/rho_L$: the traditional condition, which takes its "),
        "velocity from the left and its stress from the right, is restricted where the ",
        Strong("right"),
        " side is the denser one. Section 2's Table 1 says so too: (2.4), with the solid on the left, is unstable for ",
        "light solids. Growth rates and figures of Section 4 come out as printed for ",
        *prose("$rho_R/rho_L$ and not for $rho_L/rho_R$."),
    )
    neutral = results["neutral"]
    at_one: Text = ("0.4397 at equal densities is a slip of digits",)
    if neutral.refused is None:
        at_one = ("The largest λ at equal densities is ", neutral.number("lam_max_at_1", digits=8), ", not 0.4397.")
    items = [inverted, at_one, swapped, *((Strong(f"{where}: "), *prose(what)) for where, what in SLIPS)]
    blocks: list[Block] = [Listing(tuple(items))]
    readings = results["readings"]
    if readings.refused is None:
        rows: list[tuple[Text, ...]] = []
        for k, reading in enumerate(readings.get("readings")):
            count: Text = ("–",)
            if reading["agreeing"] is not None:
                count = (readings.number("readings", k, "agreeing"), " of 18")
            rows.append(((reading["reading"],), count, (readings.quote("readings", k, "consequence"),)))
        columns: tuple[Text, ...] = (("reading",), ("entries as printed",), ("what comes of it",))
        blocks.append(Table(("Readings of Section 2 that were not taken.",), columns, tuple(rows)))
    return Section("differences", "Differences from print, explained", tuple(blocks))


# Error against run time -----------------------------------------------------------------------------------------------


def work_section(stem: str, results: Results) -> Section:
    """The work-precision figures and table, on this machine."""
    title = "Error against run time"
    result = results["work"]
    if result.refused is not None:
        return Section("work", title, (missing(result),))
    rows = result.get("rows")
    shown_rows: list[tuple[Text, ...]] = []
    for k, row in enumerate(rows):
        seconds: Text = (Seconds(shown(row["seconds"], 3)),)
        spread: Text = (Seconds(f"{shown(row['fastest_s'], 3)} to {shown(row['slowest_s'], 3)}"),)
        error: Text = (result.number("rows", k, "error", digits=3),)
        shown_rows.append(((row["method"],), (row["setting"],), error, seconds, spread))
    columns: tuple[Text, ...] = (("method",), ("setting",), ("error",), ("seconds",), ("fastest to slowest",))
    subjects = {"solver": "The reference solver", "analyser": "lam_max by every route"}
    panels = tuple(
        Panel(partial(figures.draw_work, [row for row in rows if row["subject"] == subject]), words, 0.95)
        for subject, words in subjects.items()
    )
    notes = result.get("notes")
    figure = Figure(
        f"{stem}-work",
        ("Error over seconds: the reference solver at t = 0.5, and the largest stable λ near equal densities.",),
        "Second order beats first order at every run time; the numeric and the certified routes are at rounding error "
        "or far below it, a bisected march at 10⁻⁷.",
        panels,
        {"": Data({key: [row[key] for row in rows] for key in rows[0]})},
    )
    table = Table(("Medians of the repetitions.",), columns, tuple(shown_rows), frozenset({2, 3, 4}))
    machine = [Paragraph((Seconds(note),)) for note in notes]
    return Section("work", title, (figure, table, *machine))
