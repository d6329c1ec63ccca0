"""Cases that were once taken wrongly, or that look as if they might be, each within its limits of time and memory."""

from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.examples import examples
from tests.fuzz.case import FILE, OUTPUTS, Case, parsed
from tests.fuzz.mutations import command_line, mutated
from tests.fuzz.replay import faults
from tests.fuzz.sandbox import answer_faults, complaints, warm_up
from tests.fuzz.worker import CATALOGUE, CORPUS

SCHEMES = [path.read_bytes() for path in sorted(CATALOGUE.glob("*-1.toml"))]
CHEAP = [Case(("modes", FILE, "--json", "--limit", "1"), text) for text in SCHEMES] + [
    Case(("derive", FILE), text) for text in SCHEMES
]


def test_every_case_of_the_corpus_is_taken_well() -> None:
    assert faults(sorted(CORPUS.glob("*.case"))) == {}


@pytest.fixture(scope="module")
def warm() -> None:
    warm_up()


@pytest.mark.usefixtures("warm")
@examples(60)
@given(st.sampled_from(CHEAP), st.randoms())
def test_edited_files_are_taken_well(tmp_path_factory: pytest.TempPathFactory, case: Case, random: Random) -> None:
    """Time is the business of the corpus and of `python -m tests.fuzz`: here it would depend on what else runs."""
    edited = Case(case.arguments, mutated(case, random).payload)
    assert complaints(edited, tmp_path_factory.mktemp("case"), slack=20) == []


@given(st.randoms())
def test_a_case_is_kept_as_it_is(random: Random) -> None:
    case = mutated(Case(command_line(random), b"title = 1\n"), random)
    assert case.stored
    assert parsed(case.data()) == case


@pytest.mark.parametrize(
    "arguments",
    [
        ("fuzz", FILE),
        ("curve", FILE, "-o", "HERE/x.csv"),
        ("curve", FILE, "-o", "../x.csv"),
        ("curve", FILE, "-ox.csv"),
        (),
    ],
)
def test_no_command_line_is_made_up_that_could_do_harm(arguments: tuple[str, ...], tmp_path: Path) -> None:
    made_up = Case(tuple(text.replace("HERE", str(tmp_path)) for text in arguments), b"x")
    assert not made_up.stored
    assert parsed(made_up.data()).arguments == ("modes", FILE, "--json")


def test_what_may_be_written_to_lies_in_the_sandbox() -> None:
    assert Case(("curve", FILE, "-o", "out.csv"), b"x").stored
    assert not any(Path(name).is_absolute() or ".." in name for name in OUTPUTS)


class TestTheSandboxSaysNo:
    """Each of the things that must not happen is seen when it does."""

    def test_a_status_that_is_neither(self) -> None:
        assert answer_faults(1, "", "gks: no", as_json=False)
        assert not answer_faults(2, "", "gks: no\n", as_json=False)

    @pytest.mark.parametrize(
        "message", ["", "Traceback\n  File\n", "gks: a\ngks: b\n", "gks: \x1b[2J\n", "out of place\n"]
    )
    def test_not_one_message(self, message: str) -> None:
        assert answer_faults(2, "", message, as_json=False)

    @pytest.mark.parametrize("out", ["", "{}", '{"schema": NaN}', '{"schema": 1} x', "[1]"])
    def test_not_one_object(self, out: str) -> None:
        assert answer_faults(0, out, "", as_json=True)

    def test_a_result_beside_a_fault(self) -> None:
        assert answer_faults(2, "{}", "gks: no\n", as_json=True)

    @pytest.mark.parametrize(
        "deed",
        [
            "__import__('os').system('true')",
            "open('/dev/full', 'w')",
            "open('/etc/passwd')",
            "open('executed', 'w').close()",
            "open('scheme.toml', 'a').write('x')",
            "__import__('subprocess').run(['true'])",
            "eval('1 + 1')",
            "bytearray(600_000_000)",
            "sum(1 for _ in iter(int, 1))",
        ],
    )
    def test_a_deed(self, deed: str, tmp_path: Path) -> None:
        """A program that does what it must not, by a stand-in for `gks` in a process of its own, with a second each."""
        case = tmp_path / "a.case"
        case.write_bytes(Case(("modes", FILE), b"title = 1\n").data())
        program = (
            f"from tests.fuzz import replay, sandbox\nsandbox.main = lambda a: {deed}\nsandbox.warm_up = lambda: 0\n"
            "sandbox.COMMAND_SECONDS = 1.0\n"
        )
        found = faults([case], program + "replay.main()")
        assert list(found) == ["a.case"], found
