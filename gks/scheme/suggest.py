"""The nearest of the known names, for messages about an unknown one."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice


def nearest(word: str, known: Iterable[str]) -> str:
    """`did you mean "alpha"?`, or "" if nothing known is near; long words and long lists are not searched."""
    if len(word) > 100:
        return ""
    from difflib import get_close_matches  # imported late: it is slow to load and seldom needed

    close = get_close_matches(word, list(islice(known, 500)), n=1, cutoff=0.6)
    return f'did you mean "{close[0]}"?' if close else ""
