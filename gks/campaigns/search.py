"""Drawing and shrinking, which are hypothesis's: the drafts of a chunk, and the simplest that shows what one shows."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import TYPE_CHECKING

from gks.campaigns.draw import Draft, drafts
from gks.errors import InputError

if TYPE_CHECKING:
    from hypothesis import settings

ROUNDS = 8
"""Times a chunk is drawn from when many of its draws are alike; the space of drafts is far larger than a chunk."""


def hypothesis_version() -> str:
    """The version of hypothesis, on which the draws depend; InputError where it isn't installed."""
    try:
        from hypothesis import __version__
    except ModuleNotFoundError:
        raise InputError(
            "random schemes are drawn by the package hypothesis", mend="pip install 'gks-stability[fuzz]'"
        ) from None
    return str(__version__)


def drawn(seed: int, chunk: int, size: int) -> list[Draft]:
    """So many different drafts, the same ones for the same arguments (and version of hypothesis)."""
    found: dict[Draft, None] = {}

    def collect(draft: Draft) -> bool:
        if len(found) < size:
            found[draft] = None
        return False

    for attempt in range(ROUNDS):
        if len(found) < size:
            _find(collect, seed, chunk, size, attempt)
    return list(found)


def shrunk(seed: int, chunk: int, size: int, draft: Draft, shows: Callable[[Draft], bool]) -> Draft:
    """The simplest draft found that ``shows`` holds for; ``draft``, one of the chunk's, where none simpler is."""
    from hypothesis.errors import Flaky

    for attempt in range(ROUNDS):
        try:
            found = _find(shows, seed, chunk, size, attempt)
        except Flaky:  # what it shows is not a function of the draft alone: an overloaded machine, a fault of a library
            return draft
        if found is not None:
            return found
    return draft


def _find(condition: Callable[[Draft], bool], seed: int, chunk: int, size: int, attempt: int) -> Draft | None:
    """Draws until the condition holds, and shrinks; None where it never does. The draws before that are always the
    same."""
    from hypothesis import find
    from hypothesis.errors import NoSuchExample

    try:
        # A text seeds Random by its SHA-512, on every machine alike.
        return find(drafts(), condition, settings=_settings(size), random=Random(f"{seed}:{chunk}:{attempt}"))
    except NoSuchExample:
        return None


def _settings(size: int) -> settings:
    from hypothesis import Phase, Verbosity, settings

    return settings(
        max_examples=max(20, 2 * size),  # about a fifth of the draws repeat an earlier one
        phases=(Phase.generate, Phase.shrink),
        database=None,
        deadline=None,
        derandomize=False,
        verbosity=Verbosity.quiet,
    )
