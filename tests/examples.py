"""How many random examples a test draws: a number for the usual profile, and its share under another."""

from __future__ import annotations

from collections.abc import Sequence

from hypothesis import HealthCheck, settings

USUAL = 100
"""Examples of a profile that does not say how many; `brief` and `long` (tests/conftest.py) say."""


def examples(count: int, quiet: Sequence[HealthCheck] = ()) -> settings:
    """So many random examples under the usual profile, in proportion under others, and one at least.

    ``quiet`` names health checks that a test is known to fail, as one whose drafts are often filtered out.
    """
    assert settings.default is not None
    share = settings.default.max_examples / USUAL
    return settings(max_examples=max(1, int(count * share)), suppress_health_check=quiet)
