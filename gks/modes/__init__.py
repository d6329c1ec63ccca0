"""The mathematics: the normal modes of a scheme.

The public names are found here and loaded when first used, so that a command pays only for what it needs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gks.modes.analysis import analyse
    from gks.modes.derivation import Derivation, derive
    from gks.modes.verdict import Mode, ModeKind, ModesResult, Verdict

__all__ = ["Derivation", "Mode", "ModeKind", "ModesResult", "Verdict", "analyse", "derive"]

_HOME = {
    "Derivation": "derivation",
    "Mode": "verdict",
    "ModeKind": "verdict",
    "ModesResult": "verdict",
    "Verdict": "verdict",
    "analyse": "analysis",
    "derive": "derivation",
}


def __getattr__(name: str) -> object:
    if name in _HOME:
        from importlib import import_module

        return getattr(import_module(f"gks.modes.{_HOME[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
