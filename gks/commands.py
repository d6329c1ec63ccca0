"""What each command does, from parsed arguments to the text to print: nothing is printed before all is computed."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from gks.errors import InputError, quoted

if TYPE_CHECKING:
    from argparse import Namespace

    from gks.bounds.curve import Curve


class Result(Protocol):
    """What every analysis gives: a text for people (`str`) and the contract's JSON object."""

    def to_json(self) -> Mapping[str, object]: ...


class Tabular(Protocol):
    """A result that is a table as well."""

    def to_csv(self) -> str: ...


def carry_out(arguments: Namespace) -> str:
    """The text that the command prints; InputError where the input is at fault."""
    return _COMMANDS[arguments.command](arguments)


def settings(texts: Sequence[str]) -> dict[str, str]:
    """The -p options as a mapping from parameter to value, still text; InputError for one that is not NAME=VALUE."""
    values: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"-p {quoted(text)}", expected="expected NAME=VALUE", mend="for example -p alpha=9/10")
        if name in values:
            raise InputError(f"-p sets {quoted(name)} twice", mend="leave one of the two out")
        values[name] = value
    return values


def json_text(result: Result) -> str:
    """The one JSON object of a result; ValueError for a NaN or an infinity, which the contract spells as strings."""
    import json

    return json.dumps(result.to_json(), allow_nan=False)


def _shown(result: Result, arguments: Namespace) -> str:
    return json_text(result) if arguments.json else str(result)


def _list(arguments: Namespace) -> str:
    from gks.catalogue import Listing

    return _shown(Listing(), arguments)


def _new(arguments: Namespace) -> str:
    from gks.files import write_new
    from gks.starter import starter

    path: str = arguments.name if arguments.name.endswith(".toml") else arguments.name + ".toml"
    title = os.path.basename(path).removesuffix(".toml")
    if not title or not title.isprintable():
        raise InputError(f"{quoted(path)} can't name a scheme file", expected="a name in printable characters")
    try:
        write_new(path, starter(title))
    except FileExistsError:
        raise InputError(f"{quoted(path)} exists and is left as it is", mend="choose another name") from None
    except FileNotFoundError:
        raise InputError(f"no folder {quoted(os.path.dirname(path))}", mend="make it first") from None
    return path


def _derive(arguments: Namespace) -> str:
    from gks.api import load

    return _shown(load(arguments.file).derive(settings(arguments.settings)), arguments)


def _modes(arguments: Namespace) -> str:
    from gks.api import load

    return _shown(load(arguments.file).modes(settings(arguments.settings)), arguments)


def _curve(arguments: Namespace) -> str:
    from gks.api import load

    writers = {path: _writer(path) for path in arguments.outputs}  # refused, if at all, before the work is done
    result = load(arguments.file).curve(settings(arguments.settings), sweep=arguments.sweep)
    for path, write in writers.items():
        write(result, path)
    return "\n".join(writers) if writers and not arguments.json else _shown(result, arguments)


def _prove(arguments: Namespace) -> str:
    from gks.api import load

    if arguments.output is not None:
        _writer(arguments.output, (".json",))
    theorem = load(arguments.file).prove(
        settings(arguments.settings), limit=arguments.limit, progress=_said_to_a_terminal
    )
    if arguments.output is not None and theorem.proved:
        import json

        from gks.files import write_text

        write_text(arguments.output, json.dumps(theorem.certificate, allow_nan=False, indent=1) + "\n")
    return _shown(theorem, arguments)


def _check(arguments: Namespace) -> str:
    from gks.bounds.check import check

    result = check(_certificate(arguments.file))
    if not result.accepted:
        raise InputError(f"{quoted(arguments.file)} is rejected: {result.problem}")
    return _shown(result, arguments)


def _certificate(path: str) -> dict[str, object]:
    """A certificate file, or the JSON of a theorem that holds one; InputError if it is neither."""
    import json

    from gks.files import read_bytes

    try:
        found = json.loads(read_bytes(path, CERTIFICATE_BYTES))
    except (ValueError, RecursionError):
        found = None
    if isinstance(found, dict) and isinstance(found.get("certificate"), dict):
        found = found["certificate"]
    if not isinstance(found, dict):
        raise InputError(f"{quoted(path)} holds no JSON object", expected="a certificate that `gks prove -o` wrote")
    return found


CERTIFICATE_BYTES = 50_000_000
"""Far above what a theorem of this program takes."""


def _audit(arguments: Namespace) -> str:
    if arguments.all:
        if arguments.file is not None:
            raise InputError(f"both --all and {quoted(arguments.file)}", mend="leave one of the two out")
        from gks.bounds.audit import audit_catalogue
        from gks.solvers.march import march

        return _shown(audit_catalogue(march, progress=_said_to_a_terminal), arguments)
    if arguments.file is None:
        raise InputError("nothing to audit", expected="expected FILE or --all")
    from gks.api import load

    return _shown(load(arguments.file).audit(), arguments)


def _said_to_a_terminal(progress: str) -> None:
    """Progress on standard error, where someone is looking."""
    if sys.stderr.isatty():
        print(progress, file=sys.stderr)


def _march(arguments: Namespace) -> str:
    from gks.api import load

    scheme = load(arguments.file)
    given = settings(arguments.settings)
    return _shown(scheme.march(given, cells=arguments.cells, steps=arguments.steps), arguments)


def _bench(arguments: Namespace) -> str:
    from gks.reports.bench import bench

    writers = {path: _writer(path, (".csv", ".json")) for path in arguments.outputs}
    table = bench(arguments.table, _said_to_a_terminal)
    for path, write in writers.items():
        write(table, path)
    return "\n".join(writers) if writers and not arguments.json else _shown(table, arguments)


def _writer(
    path: str, endings: Sequence[str] = (".csv", ".json", ".png", ".svg", ".pdf")
) -> Callable[[Any, str], None]:
    """What writes a result to a file of that name, by its ending; InputError if nothing does or there is no folder."""
    ending = os.path.splitext(path)[1].lower()
    if ending not in endings:
        found = f"nothing is written as {quoted(ending)}" if ending else "its name has no ending"
        listed = " or ".join(filter(None, [", ".join(endings[:-1]), endings[-1]]))
        raise InputError(f"-o {quoted(path)}: {found}", expected=f"expected {listed}")
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise InputError(f"-o {quoted(path)}: no folder {quoted(folder)}", mend="make it first")
    if os.path.isdir(path):
        raise InputError(f"-o {quoted(path)} is a folder", expected="expected the name of a file")
    writers: dict[str, Callable[[Any, str], None]] = {".csv": _write_csv, ".json": _write_json}
    return writers.get(ending, _draw)


def _write_csv(result: Tabular, path: str) -> None:
    from gks.files import write_text

    write_text(path, result.to_csv())


def _write_json(result: Result, path: str) -> None:
    from gks.files import write_text

    write_text(path, json_text(result) + "\n")


def _draw(curve: Curve, path: str) -> None:
    from gks.reports.figures import save_curve

    save_curve(curve, path)


_COMMANDS: dict[str, Callable[[Namespace], str]] = {
    "list": _list,
    "new": _new,
    "derive": _derive,
    "modes": _modes,
    "curve": _curve,
    "prove": _prove,
    "check": _check,
    "audit": _audit,
    "march": _march,
    "bench": _bench,
}
