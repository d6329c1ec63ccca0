"""The paper's theory: Theorems 3.1 to 3.5 and Figure 3, and all of its statements audited."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from gks.reports import paper_figures as figures
from gks.reports.document import (
    Block,
    Data,
    Figure,
    Formula,
    Link,
    Panel,
    Paragraph,
    Result,
    Section,
    Strong,
    Table,
    Text,
    prose,
)
from gks.reports.formulas import cases, formula
from gks.reports.paper_experiments import missing
from gks.reports.printed import THEOREMS, UNEQUAL, PrintedTheorem
from gks.reports.scheme_answers import claim_rows, proved, stated, unproved
from gks.reports.scheme_topics import fixed

Results = Mapping[str, Result]


def analysis_section(stem: str, results: Results) -> Section:
    """Section 3: each theorem as printed and as proved, then Figure 3."""
    blocks: list[Block] = []
    for theorem in THEOREMS:
        blocks += _theorem(theorem, results)
    blocks.append(Paragraph((Strong("The remarks on unequal wave speeds"), " after Theorems 3.3 and 3.5:")))
    for name in UNEQUAL:
        blocks += _proved(results[f"theorem-{name}"], f"Stable region of {name}, c_R = 2 c_L")
    blocks.append(_figure_3(stem, results))
    return Section("analysis", "Section 3: the theorems", tuple(blocks))


def _theorem(theorem: PrintedTheorem, results: Results) -> list[Block]:
    head: Text = (Strong(f"Theorem {theorem.number}"), f" ({theorem.about}). As printed, stable for")
    blocks: list[Block] = [Paragraph(head), Formula(formula(theorem.bound), f"Theorem {theorem.number} as printed")]
    derived = results[f"derive-{theorem.scheme}"]
    if derived.refused is None:
        blocks.append(Paragraph(("Derived: a normal mode exists where",)))
        text = derived.get("characteristic_polynomial")
        place = f"/results/{derived.name}/result/characteristic_polynomial"
        blocks.append(Formula(formula(f"{text} = 0"), "Its characteristic polynomial", place))
        blocks.append(Formula(formula(derived.get("root_map")), "Its root map"))
    blocks += _proved(results[f"theorem-{theorem.scheme}"], f"Theorem {theorem.number} as derived")
    blocks.append(Paragraph(prose(theorem.note)))
    return blocks


def _proved(result: Result, label: str) -> list[Block]:
    if result.refused is not None:
        return [missing(result)]
    if not proved(result):
        return [Paragraph(unproved(result))]
    rows, _ = stated(result.get("statement"))
    held = fixed(result)
    file = result.get("certificate", "file")
    return [
        Paragraph((Strong("Proved", "good"), *prose(", with $alpha = rho_R/rho_L$"), *held, ": stable exactly for")),
        Formula(cases(rows), label),
        Paragraph(("Certificate ", Link(file, file), ", ", Strong("accepted", "good"), " by the checker.")),
    ]


def _figure_3(stem: str, results: Results) -> Block:
    names = {
        "traditional, first order": "traditional-1",
        "traditional, second order": "traditional-2",
        "weighted": "weighted-2",
    }
    for name in names.values():
        if results[f"curve-{name}"].refused is not None:
            return missing(results[f"curve-{name}"])
    curves = {label: results[f"curve-{name}"].record["result"] for label, name in names.items()}
    points = curves["traditional, second order"]["points"]
    columns = {
        "alpha": [point["alpha"] for point in points],
        **{name: [p["lam_max"] for p in curves[label]["points"]] for label, name in names.items()},
    }
    return Figure(
        f"{stem}-figure-3",
        (
            "Figure 3: the largest stable CFL number of the second-order condition over the ratio, with first order "
            "and the weighted condition beside it.",
        ),
        "The weighted condition keeps 1 throughout. The traditional one leaves it at 3 at first order and at "
        "√17 − 4 ≈ 0.123 at second order, and falls like 4/α and 20/(27α).",
        (Panel(partial(figures.draw_bounds, curves)),),
        {"": Data(columns)},
    )


def audit_section(results: Results) -> Section:
    """All statements that the scheme files hold, as printed, against what is derived."""
    rows: list[tuple[Text, ...]] = []
    for name, result in results.items():
        if not name.startswith("audit-"):
            continue
        if result.refused is not None:
            rows.append((("not computed",), (name,), ("",), (result.refused,)))
            continue
        rows += claim_rows(result)
    columns: tuple[Text, ...] = (("",), ("source",), prose("claimed, with $ratio = rho_L/rho_R$"), ("derived",))
    told = Paragraph(
        (
            *prose("Each statement as it is printed, with $rho_L/rho_R$ for its ratio, held against the derivation. "),
            "Those that fail come with exact values at which they do.",
        )
    )
    return Section("audit", "The paper's statements, held as printed", (told, Table((), columns, tuple(rows))))
