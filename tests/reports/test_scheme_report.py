"""The report of a scheme: a page that stands alone, whose every number is in the record and can be had again."""

import csv
import json
import re
from pathlib import Path
from typing import Any

import pytest

from gks.catalogue import find
from gks.reports.crew import run
from gks.reports.document import shown
from gks.reports.report import scheme_report, stem_of
from gks.reports.scheme_plan import plan, sweep_of
from gks.reports.steps import Step
from gks.scheme.schemefile import parse_scheme
from tests.bounds.theorem_schemes import LEAPFROG_OUTFLOW
from tests.reports.example import EXAMPLE, TEXT, Page, Silent, at, written

Report = tuple[Path, dict[str, str], dict[str, Any]]


@pytest.fixture(scope="module")
def page(report: Report) -> Page:
    return Page(report[1]["html"])


def test_it_is_one_file_and_fetches_nothing(report: Report, page: Page) -> None:
    (policy,) = [a["content"] for a, _ in page.all("meta") if a.get("http-equiv") == "Content-Security-Policy"]
    assert policy.startswith("default-src 'none'")
    assert page.all("script") == []
    addresses = [a[key] for _, a in page.elements for key in ("src", "href") if key in a]
    assert not any(re.match(r"(https?:)?//", address) for address in addresses)
    files = {a for a in addresses if not a.startswith(("#", "data:"))}
    assert all((report[0] / file).is_file() for file in files)
    assert {"example.json", "example-curve.csv", "example-certificate.json"} <= files


def test_identifiers_are_unique_and_links_within_the_page_arrive(page: Page) -> None:
    ids = [a["id"] for _, a in page.elements if "id" in a]
    assert len(ids) == len(set(ids))
    targets = {a["href"][1:] for _, a in page.elements if a.get("href", "").startswith("#")}
    assert targets <= set(ids)
    labels = {word for _, a in page.elements for word in a.get("aria-labelledby", "").split()}
    assert labels <= set(ids)


def test_landmarks_and_text_equivalents(page: Page) -> None:
    assert [len(page.all(tag)) for tag in ("header", "nav", "main", "footer", "h1")] == [1] * 5
    assert len(page.all("h2")) == len(page.all("section"))
    assert ("lang", "en") in page.all("html")[0][0].items()
    figures = page.all("figure")
    assert len(figures) == len(page.all("figcaption")) == 7
    plots = [a for a, _ in page.all("svg")]
    assert len(plots) >= len(figures)
    assert all(a["role"] == "img" and "viewbox" in a for a in plots)
    assert len(page.all("desc")) == len(plots)
    assert all(len(text) > 20 for _, text in page.all("desc"))


def test_every_section_is_there_and_the_title_is_text(page: Page) -> None:
    assert [a["id"] for a, _ in page.all("section")] == [
        "scheme", "polynomial", "modes", "curve", "map", "theorem", "march", "audit", "provenance",
    ]  # fmt: skip
    assert page.all("h1")[0][1] == EXAMPLE.title
    assert page.all("b") == []


def place(attributes: dict[str, str]) -> tuple[str, str]:
    """(the result's name, the pointer into it) of a number on the page."""
    name, _, rest = attributes["data-place"].removeprefix("/results/").partition("/result/")
    return name, f"/{rest}"


def recomputed(record: dict[str, Any], names: set[str]) -> dict[str, Any]:
    """The results of these names from what the record says of how they came about, and from nothing else."""
    source = (record["schemes"]["example"], "example", None)
    steps = [Step(n, record["results"][n]["kind"], record["results"][n]["arguments"], source) for n in sorted(names)]
    found: dict[str, Any] = {}
    run(steps, 2, Silent(), lambda step, result: found.update({step.name: result["result"]}))
    return found


def test_thirty_numbers_of_the_page_are_in_the_record_and_computed_again(report: Report, page: Page) -> None:
    record = report[2]
    numbers = [(a, text) for a, text in page.all("data") if re.fullmatch(r"[+−]? ?[\d.]+( × 10[⁻⁰-⁹¹²³]+)?", text)]
    chosen = numbers[:: max(1, len(numbers) // 30)]
    assert len(chosen) >= 30
    names = {place(a)[0] for a, _ in chosen}
    again = recomputed(record, names)
    for attributes, text in chosen:
        value = at(record, attributes["data-place"])
        assert str(value) == attributes["value"]
        name, rest = place(attributes)
        computed = at(again[name], rest)
        assert computed == value
        digits = len(re.sub(r"[^\d]", "", text.partition(" × ")[0]).lstrip("0"))
        assert any(shown(computed, d) == re.sub(r"^\+ |(?<=−) ", "", text) for d in range(1, max(digits, 1) + 6))


def test_the_formulas_and_quotations_are_the_record_s(report: Report, page: Page) -> None:
    places = [a["data-place"] for _, a in page.elements if "data-place" in a]
    assert "/results/derive/result/characteristic_polynomial" in places
    assert all(at(report[2], place) is not None for place in places)
    assert report[2]["results"]["derive"]["result"]["characteristic_polynomial"] == "4*r**2 - 4*r + alpha + 1"


def test_the_data_files_hold_what_the_figures_show(report: Report) -> None:
    folder, _, record = report
    with open(folder / "example-curve.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    points = record["results"]["curve"]["result"]["points"]
    assert [float(row["lam_max"]) for row in rows] == [point["lam_max"] for point in points]
    assert [float(row["alpha"]) for row in rows] == [point["alpha"] for point in points]
    certificate = json.loads((folder / "example-certificate.json").read_text(encoding="utf-8"))
    from gks.bounds.check import check

    assert check(certificate).accepted


def untimed(value: Any) -> Any:
    """JSON without what is called seconds, at any depth."""
    if isinstance(value, dict):
        return {key: untimed(item) for key, item in value.items() if key != "seconds"}
    return [untimed(item) for item in value] if isinstance(value, list) else value


def test_two_runs_differ_in_dates_and_times_alone(report: Report, tmp_path: Path) -> None:
    second, record = written(tmp_path, "html")

    def timeless(text: str) -> str:
        return re.sub(r"<time.*?</time>", "", text)

    assert timeless(second["html"]) == timeless(report[1]["html"])
    assert untimed(record) == untimed(report[2])
    names = {path.name for path in tmp_path.iterdir() if path.suffix == ".csv"}
    assert names
    assert all((tmp_path / name).read_bytes() == (report[0] / name).read_bytes() for name in names)


def test_a_second_run_in_the_same_folder_computes_nothing(report: Report) -> None:
    watcher = Silent()
    scheme_report(EXAMPLE, str(report[0]), watcher)
    assert watcher.computed == []
    assert set(watcher.kept) > set(report[2]["results"])  # the pictures are kept too


def test_markdown_has_the_figures_and_escapes_the_title(report: Report) -> None:
    text = report[1]["md"]
    assert text.startswith(r"# Coupling \<b\>&\</b\>")
    images = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text)
    assert len(images) >= 7
    assert all((report[0] / image).read_text(encoding="utf-8").startswith("<?xml") for image in images)
    columns = [line.count("|") - line.count(r"\|") for line in text.splitlines() if line.startswith("|")]
    assert columns


# What a scheme has no use for -----------------------------------------------------------------------------------------

def test_nothing_is_computed_for_a_section_without_use() -> None:
    bare = parse_scheme(LEAPFROG_OUTFLOW, "bare")
    assert "audit" not in {step.name for step in plan(bare)}
    assert sweep_of(bare) is None
    exact_time = parse_scheme(TEXT.replace("forward-euler", "exact"), "exact-time")
    assert not {"curve", "theorem", "radius"} & {step.name for step in plan(exact_time)}


@pytest.mark.parametrize(
    ("ends", "expected"),
    [
        ("[0, inf]", "alpha=1/2500:40000:121:log"),
        ("[1e-4, 1e4]", "alpha=1/10000:10000:121:log"),
        ("[0, 1]", "alpha=1/20000:1:121:log"),
        ("[1, 2]", "alpha=243/242:483/242:121"),
        ("[-1, 1]", "alpha=-120/121:120/121:121"),
        ("[-inf, inf]", None),
        ("[-inf, 0]", None),
        ("[3, inf]", None),
    ],
)
def test_sweeps_stay_inside_the_range(ends: str, expected: str | None) -> None:
    from gks.bounds.sweep import parse_sweep

    default = "0.5" if ends == "[0, 1]" else "4"
    scheme = parse_scheme(TEXT.replace("[0, inf]", ends).replace("default = 4", f"default = {default}"), "swept")
    sweep = sweep_of(scheme)
    assert sweep is not None
    if expected is not None:
        assert sweep == expected
    parameter = scheme.parameter("alpha")
    values = parse_sweep(sweep).values
    assert all(parameter.low is None or v >= parameter.low for v in values)
    assert all(parameter.high is None or v <= parameter.high for v in values)


def test_shipped_schemes_can_all_be_planned() -> None:
    from gks import catalogue

    for name in catalogue.names():
        steps = plan(find(name))
        assert len({step.name for step in steps}) == len(steps)


NAMES = [("../../x", "x"), ("a b/c", "a-b-c"), ("1-2", "scheme-1-2"), ("", "scheme")]


@pytest.mark.parametrize(("given", "stem"), NAMES)
def test_a_scheme_s_name_cannot_lead_out_of_the_folder(given: str, stem: str) -> None:
    assert stem_of(parse_scheme(LEAPFROG_OUTFLOW, given)) == stem
