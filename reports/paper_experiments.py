"""The paper's experiments: the Riemann problem of Section 2 and 4.1, the acoustic pulses of Section 4."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from gks.reports import paper_figures as figures
from gks.reports.document import (
    Block,
    Data,
    Figure,
    Link,
    Panel,
    Paragraph,
    Result,
    Section,
    Strong,
    Table,
    Text,
    prose,
    shown,
)

Results = Mapping[str, Result]


def introduction_section(stem: str, results: Results) -> Section:
    """Section 2 and Section 4.1: the gas and the elastic solid."""
    blocks: list[Block] = [
        _riemann(stem, results, 2, "(2.4) with the solid's density 2"),
        *_table_1(results["table-1"]),
        *_thresholds(results),
        Paragraph(("Section 4.1: the weighted condition (4.3) for the same problem.",)),
        _riemann(stem, results, 10, "(4.3) with the solid's density 0.001"),
        _riemann(stem, results, 11, "(4.3) with the solid's density 1000"),
        *_extremes(results["table-1"]),
    ]
    return Section("introduction", "Sections 2 and 4.1: a gas and an elastic solid", tuple(blocks))


def missing(result: Result) -> Paragraph:
    """What stands where a result does not."""
    return Paragraph((Strong("not computed", "open"), f": {result.refused}."))


def _riemann(stem: str, results: Results, number: int, what: str) -> Block:
    result = results[f"figure-{number}"]
    if result.refused is not None:
        return missing(result)
    data = result.record["result"]
    error = max(abs(v) for v in data["solid"]["velocity"] + data["gas"]["velocity"])
    columns = {
        "side": ["solid"] * len(data["solid"]["x"]) + ["gas"] * len(data["gas"]["x"]),
        **{key: data["solid"][key] + data["gas"][key] for key in ("x", "velocity", "stress")},
    }
    exact = {
        "side": ["solid"] * len(data["exact_solid"]["x"]) + ["gas"] * len(data["exact_gas"]["x"]),
        **{key: data["exact_solid"][key] + data["exact_gas"][key] for key in ("x", "velocity", "stress")},
    }
    seen = (
        f"{len(data['solid']['x'])} cells a side at t = {shown(data['time'], 3)}; crosses and circles lie on the exact "
        f"solution's constant states, smeared over some cells at its waves; the largest velocity is {shown(error, 4)}."
    )
    return Figure(
        f"{stem}-figure-{number}",
        (f"Figure {number}: the Riemann problem under {what}; velocity and stress over the physical coordinate.",),
        seen,
        (
            Panel(partial(figures.draw_riemann, data, "velocity"), "Velocity"),
            Panel(partial(figures.draw_riemann, data, "stress"), "Stress"),
        ),
        {"": Data(columns), "-exact": Data(exact)},
    )


def _table_1(result: Result) -> list[Block]:
    if result.refused is not None:
        return [missing(result)]
    entries = result.get("entries")
    densities = list(dict.fromkeys(entry["density"] for entry in entries))
    conditions = list(dict.fromkeys(entry["condition"] for entry in entries))
    rows = []
    for condition in conditions:
        mine = [entry for entry in entries if entry["condition"] == condition]
        cells: list[Text] = [(f"{mine[0]['source'].partition(':')[0]}",)]
        for entry in mine:
            word, printed = ("stable" if entry[key] else "unstable" for key in ("stable", "printed"))
            cells.append((word if entry["agrees"] else Strong(f"{word}, printed {printed}", "bad"),))
        rows.append(tuple(cells))
    agree = sum(entry["agrees"] for entry in entries)
    theory = sum(entry["predicted_stable"] is entry["printed"] for entry in entries)
    caption: Text = (
        f"Table 1 at CFL 0.9 and t = 1.1, by the density of the solid: {agree} of {len(entries)} entries as printed.",
    )
    columns: tuple[Text, ...] = (("condition",), *((f"{shown(rho)}",) for rho in densities))
    told = Paragraph(
        (
            f"Linear theory at the state between the waves of the exact solution predicts {theory} of {len(entries)} "
            "entries. A run counts as unstable if the pressure turns negative or, in its last fifth, solid and gas "
            "differ by more than 0.01 in velocity next to the interface.",
        )
    )
    return [Table(caption, columns, tuple(rows)), told]


def _thresholds(results: Results) -> list[Block]:
    found = [result for name, result in results.items() if name.startswith("threshold-")]
    rows: list[tuple[Text, ...]] = []
    for result in found:
        if result.refused is not None:
            rows.append(((result.name,), (f"not computed: {result.refused}",), ("",), ("",)))
            continue
        one = result.get("thresholds", 0)
        cells = (_interval(result, which) for which in ("predicted", "disturbed", "observed"))
        low, high = (shown(v) for v in one["between"])
        rows.append(((f"{one['condition']}, between {low} and {high}",), *cells))
    columns: tuple[Text, ...] = (("condition",), ("predicted",), ("small disturbance",), ("Riemann data",))
    caption: Text = ("Densities of the solid at which the answer changes: by linear theory at the star state, with a "
                     "small disturbance of that state, and with the Riemann data of Table 1.",)  # fmt: skip
    told = Paragraph(
        (
            "Theory and small disturbances agree. With Riemann data a light solid's slow decay still counts as "
            "instability at t = 1.1; a heavy one loses stability early because the velocity jump at the start is no "
            "small disturbance.",
        )
    )
    return [Table(caption, columns, tuple(rows)), told]


def _interval(result: Result, which: str) -> Text:
    low, high = (result.number("thresholds", 0, which, k, digits=5) for k in (0, 1))
    return (low,) if low.text == high.text else (low, " to ", high)


def _extremes(result: Result) -> list[Block]:
    if result.refused is not None:
        return []
    entries = result.get("weighted")
    stable = sum(entry["stable"] for entry in entries)
    low, high = (shown(f(entry["density"] for entry in entries)) for f in (min, max))
    tone = "good" if stable == len(entries) else "bad"
    return [
        Paragraph(
            (
                "(4.3) is said to be stable for arbitrary densities: ",
                Strong(f"{stable} of {len(entries)}", tone),
                f" densities from {low} to {high} are stable at CFL 0.9, those of Table 1 among them.",
            )
        )
    ]


# Section 4 ------------------------------------------------------------------------------------------------------------


def waves_section(stem: str, results: Results) -> Section:
    """Section 4: the pulses, the errors, the convergence."""
    neutral = "4/λ − 1 + 0.01", "4/λ − 1 − 0.01"
    blocks: list[Block] = [
        Paragraph(
            (
                *prose("Each ratio that the text prints as $rho_L/rho_R$ is taken as $alpha = rho_R/rho_L$ here, "),
                "which gives its growth rates and its figures; see ",
                Link("the differences", "#differences"),
                ".",
            )
        ),
        _exact(stem, results["figure-4"]),
        _errors(stem, results["figure-5"], "5", "traditional condition, first order", neutral),
        _errors(stem, results["figure-6"], "6", "weighted condition, first order", neutral),
        _errors(stem, results["figure-7"], "7", "weighted condition, extreme ratios", ("10¹⁰", "10⁻¹⁰")),
        _growth_table(results),
        _figure_8(stem, results),
        _figure_9(stem, results),
    ]
    return Section("waves", "Section 4: pulses across an interface", tuple(blocks))


def _exact(stem: str, result: Result) -> Block:
    if result.refused is not None:
        return missing(result)
    data = result.record["result"]
    columns: dict[str, Sequence[object]] = {"x": data["x"]}
    for k, time in enumerate(data["times"]):
        columns[f"velocity at t = {time:g}"] = data["velocity"][k]
        columns[f"stress at t = {time:g}"] = data["stress"][k]
    panels = tuple(
        Panel(partial(figures.draw_exact, data, k), f"$t = {time:g}$")
        for k, time in enumerate(data["times"])
    )
    seen = "A pulse on the left at first; then at the interface; at last a reflected pulse on the left and a "
    return Figure(
        f"{stem}-figure-4",
        ("Figure 4: the exact solution at the ratio 4/λ − 1.",),
        seen + "transmitted one on the right.",
        panels,
        {"": Data(columns)},
    )


def _errors(stem: str, result: Result, number: str, what: str, labels: tuple[str, str]) -> Block:
    if result.refused is not None:
        return missing(result)
    lines = result.get("lines")
    panels = tuple(
        Panel(partial(figures.draw_errors, lines, q, labels), q.capitalize())
        for q in ("velocity", "stress")
    )
    return Figure(
        f"{stem}-figure-{number}",
        (f"Figure {number}: errors over time, {what}; the dotted lines have the slope of the largest root.",),
        _seen(lines, labels),
        panels,
        {f"-{k + 1}": _history(line) for k, line in enumerate(lines)},
    )


def _history(line: Mapping[str, Any]) -> Data:
    return Data({key: line[key] for key in ("times", "velocity_error", "stress_error")})


def _seen(lines: Sequence[Mapping[str, Any]], labels: Sequence[str]) -> str:
    parts = []
    for line, label in zip(lines, labels, strict=True):
        known = [error for error in line["velocity_error"] if error is not None]
        way = "grows" if line["observed"] > 1 else "decays"
        rate, end = shown(line["observed"], 7), shown(known[-1], 2)
        parts.append(f"At {label} the velocity error {way} by the factor {rate} a step and ends at {end}")
    return ". ".join(parts) + "."


def _growth_table(results: Results) -> Table:
    rows = []
    for figure in ("5", "6", "7", "8-traditional", "8-weighted"):
        result = results[f"figure-{figure}"]
        if result.refused is not None:
            continue
        for k, line in enumerate(result.get("lines")):
            mode: Text = ("none",) if line["predicted"] is None else (result.number("lines", k, "predicted", digits=8),)
            spread = result.number("lines", k, "uncertainty", digits=2)
            rows.append(
                (
                    (figure.replace("-", ", "),),
                    (result.number("lines", k, "alpha", digits=8),),
                    mode,
                    (result.number("lines", k, "root", digits=8),),
                    (result.number("lines", k, "observed", digits=8), " ± ", spread),
                )
            )
    columns: tuple[Text, ...] = (("figure",), ("α",), ("largest mode",), ("largest root",), ("observed",))
    caption: Text = ("Growth of the velocity error a step in Figures 5 to 8: the largest admissible mode, the largest "
                     "root of the characteristic polynomial, and what is observed (99 %).",)  # fmt: skip
    return Table(caption, columns, tuple(rows), frozenset({1, 2, 3, 4}))


def _figure_8(stem: str, results: Results) -> Block:
    pair = [results["figure-8-traditional"], results["figure-8-weighted"]]
    if any(result.refused is not None for result in pair):
        return missing(next(result for result in pair if result.refused is not None))
    labels = ("0.1876 + 0.01", "0.1876 − 0.01")
    both = [result.get("lines") for result in pair]
    names = ("traditional", "weighted")
    panels = tuple(
        Panel(partial(figures.draw_errors, lines, "velocity", labels), name.capitalize())
        for lines, name in zip(both, names, strict=True)
    )
    data = {
        f"-{name}-{k + 1}": _history(line)
        for name, lines in zip(names, both, strict=True)
        for k, line in enumerate(lines)
    }
    return Figure(
        f"{stem}-figure-8",
        ("Figure 8: velocity errors under the second-order conditions with the first-order interior.",),
        f"Traditional: {_seen(both[0], labels)} Weighted: {_seen(both[1], labels)}",
        panels,
        data,
    )


def _figure_9(stem: str, results: Results) -> Block:
    studies = {name: results[f"convergence-{name}"] for name in ("traditional", "weighted")}
    for result in studies.values():
        if result.refused is not None:
            return missing(result)
    plain = {name: result.record["result"] for name, result in studies.items()}
    panels = [
        Panel(partial(figures.draw_resolutions, study["lines"]), name.capitalize())
        for name, study in plain.items()
    ]
    panels.append(Panel(partial(figures.draw_convergence, plain), "Convergence"))
    rates = ", ".join(shown(rate, 3) for rate in plain["weighted"]["rates"])
    last = shown(plain["traditional"]["errors"][-1], 2)
    columns = {
        "dx": plain["weighted"]["dx"],
        "traditional": plain["traditional"]["errors"],
        "weighted": plain["weighted"]["errors"],
    }
    histories = {
        f"-{name}-{line['cells']}": _history(line) for name, study in plain.items() for line in study["lines"]
    }
    return Figure(
        f"{stem}-figure-9",
        ("Figure 9: the fully second-order scheme (Fromm's) at the ratio 0.25, and its error at t = 0.5.",),
        f"Weighted: the error falls at the rates {rates} over the doublings. Traditional: it grows instead, to {last}.",
        tuple(panels),
        {"": Data(columns), **histories},
    )
