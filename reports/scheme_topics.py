"""The sections of a scheme's report that say what one step gave, and the sentence in their place where it gave none."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from gks.reports.document import Block, Maths, Paragraph, Result, Section, Text
from gks.reports.formulas import laid_out, name, relation
from gks.scheme.model import Scheme


@dataclass(frozen=True, slots=True)
class Answers:
    """A scheme, what the steps of its report gave, and what the names of the report's files begin with."""

    scheme: Scheme
    stem: str
    results: Mapping[str, Result]

    def given(self, step: str) -> Result | None:
        """What a step gave; None where it was not run, or has only a reason why it gave nothing."""
        result = self.results.get(step)
        return None if result is None or result.refused is not None else result


@dataclass(frozen=True, slots=True)
class Topic:
    """A section on what one step gave.

    without  begins the sentence that stands there where the step gave nothing; its reason follows
    blocks   what there is to say about the result; no blocks, no section
    """

    step: str
    anchor: str
    title: str
    without: str
    blocks: Callable[[Answers, Result], Sequence[Block]]

    def section(self, answers: Answers) -> Section | None:
        """The section; None where the step was not run or there is nothing to say."""
        result = answers.results.get(self.step)
        if result is None:
            return None
        if result.refused is not None:
            return Section(self.anchor, self.title, (Paragraph((f"{self.without}: {result.refused}.",)),))
        blocks = tuple(self.blocks(answers, result))
        return Section(self.anchor, self.title, blocks) if blocks else None


def values_text(values: Mapping[str, object]) -> Text:
    """Parameters with their values, between commas."""
    text: Text = ()
    for key, value in values.items():
        text = (*text, ", " if text else "", Maths(relation(name(key), "=", laid_out(str(value)))))
    return text


def fixed(result: Result, *running: str) -> Text:
    """What a curve, a map or paths hold fixed, all but the parameters that run, as ", at c = 2"; () for nothing."""
    values = {key: value for key, value in result.record["arguments"]["values"].items() if key not in running}
    return (", at ", *values_text(values)) if values else ()
