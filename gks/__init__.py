"""Normal-mode (GKS) stability of boundary and interface closures of difference schemes.

>>> import gks
>>> s = gks.load("traditional-1")          # a shipped scheme, or the path of a scheme file
>>> s.modes(lam="9/10", alpha="31/9").verdict
<Verdict.NEUTRAL: 'neutral'>

Importing this package imports nothing else of it: each public name is fetched when it is first asked for, so that
``gks --version`` costs what starting Python costs.
"""

from __future__ import annotations

TYPE_CHECKING = False  # type checkers take it for true by its name; `typing` itself would be a third of the start-up
if TYPE_CHECKING:
    from gks import catalogue
    from gks.api import LoadedScheme, load
    from gks.errors import GksError, InputError
    from gks.scheme.schemefile import parse_scheme, read_scheme

__version__ = "0.1.0"

__all__ = ["GksError", "InputError", "LoadedScheme", "__version__", "catalogue", "load", "parse_scheme", "read_scheme"]

_HOMES = {
    "LoadedScheme": "gks.api",
    "load": "gks.api",
    "GksError": "gks.errors",
    "InputError": "gks.errors",
    "parse_scheme": "gks.scheme.schemefile",
    "read_scheme": "gks.scheme.schemefile",
}


if not TYPE_CHECKING:  # or a type checker would take any misspelt name for one of these

    def __getattr__(name: str) -> object:
        """Fetch a public name from the module that defines it (PEP 562)."""
        from importlib import import_module

        if name == "catalogue":
            return import_module("gks.catalogue")
        if name not in _HOMES:
            raise AttributeError(f"module 'gks' has no attribute {name!r}")
        value: object = getattr(import_module(_HOMES[name]), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
