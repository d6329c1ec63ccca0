"""What each command does, from parsed arguments to the text to print: nothing is printed before all is computed."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING, Any

from gks.errors import InputError, quoted
from gks.outputs import Result, draw_profile, draw_roots, json_text, writer

if TYPE_CHECKING:
    from argparse import Namespace


def carry_out(arguments: Namespace) -> str:
    """The text that the command prints; InputError where the input is at fault, or one of `WHOLE` is over its time."""
    limit = _whole_limit(arguments) if arguments.command in WHOLE else None
    if limit is None:
        return _COMMANDS[arguments.command](arguments)
    from gks.bounds.timelimit import Died, OverTime, limited

    try:
        (text,) = limited(_report_text, (arguments,), limit)
    except Died as ended:
        raise InputError(str(ended), mend="a scheme with shorter numbers takes less") from None
    except OverTime as over:
        raise InputError(str(over), mend="--limit SECONDS allows more") from None
    return str(text)


WHOLE = frozenset({"derive", "profile", "roots", "check", "audit", "march"})
"""Commands that are done within their time limit or not at all; `modes`, `curve` and `prove` say what they have."""

LONGEST = 600.0
"""Seconds that a whole command may take unless told otherwise: a scheme file from a stranger must not hang it."""


def _whole_limit(arguments: Namespace) -> float | None:
    given: float | None = arguments.limit
    return given if getattr(arguments, "all", False) else _limit(arguments, LONGEST)


def _report_text(arguments: Namespace, report: Callable[[str], None]) -> None:
    report(_COMMANDS[arguments.command](arguments))


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

    scheme, given = load(arguments.file), settings(arguments.settings)
    return _shown(scheme.modes(given, limit=_patience(arguments), certify=arguments.certify), arguments)


def _profile(arguments: Namespace) -> str:
    from gks.api import load

    writers = {path: writer(path, draw=draw_profile) for path in arguments.outputs}
    scheme = load(arguments.file)
    result = scheme.profile(settings(arguments.settings), mode=arguments.mode, cells=arguments.cells)
    for path, write in writers.items():
        write(result, path)
    return "\n".join(writers) if writers and not arguments.json else _shown(result, arguments)


def _roots(arguments: Namespace) -> str:
    from gks.api import load

    writers = {path: writer(path, draw=draw_roots) for path in arguments.outputs}
    result = load(arguments.file).roots(settings(arguments.settings), sweep=arguments.sweep)
    for path, write in writers.items():
        write(result, path)
    return "\n".join(writers) if writers and not arguments.json else _shown(result, arguments)


def _curve(arguments: Namespace) -> str:
    from gks.api import load

    writers = {path: writer(path) for path in arguments.outputs}  # refused, if at all, before the work is done
    loaded = load(arguments.file)
    over_lam = any(text.partition("=")[0].strip() == loaded.scheme.cfl for text in arguments.sweep)
    with _counted_to_a_terminal("points") as progress:
        result = loaded.curve(
            settings(arguments.settings),
            sweep=arguments.sweep,
            jobs=arguments.jobs,
            scheduler=arguments.scheduler,
            resume=arguments.resume,
            progress=progress,
            limit=arguments.limit if over_lam else _patience(arguments),
            certify=arguments.certify,
        )
    for path, write in writers.items():
        write(result, path)
    return "\n".join(writers) if writers and not arguments.json else _shown(result, arguments)


def _limit(arguments: Namespace, otherwise: float) -> float | None:
    """The time limit asked for; without one, the usual where it costs nothing."""
    from gks.bounds.timelimit import can_fork

    given: float | None = arguments.limit
    return otherwise if given is None and can_fork() else given


def _patience(arguments: Namespace) -> float | None:
    """The time limit of a verdict, or of a point of a curve."""
    from gks.bounds.timelimit import PATIENCE

    return _limit(arguments, PATIENCE)


@contextmanager
def _counted_to_a_terminal(things: str) -> Iterator[Callable[[int, int], None] | None]:
    """Progress on standard error where someone is looking: a line written over, gone at the end however that comes."""
    if not sys.stderr.isatty():
        yield None
        return
    start = shown = perf_counter()

    def told(done: int, total: int) -> None:
        nonlocal shown
        now = perf_counter()
        if now - shown > PAUSE:
            shown = now
            left = (now - start) * (total - done) / max(done, 1)
            print(f"\r\x1b[K{done} of {total} {things}, about {left:.0f} s left", end="", file=sys.stderr, flush=True)

    try:
        yield told
    finally:
        if shown > start:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


PAUSE = 0.3
"""Seconds between two lines of progress; what takes less shows none."""


def _prove(arguments: Namespace) -> str:
    from gks.api import load

    if arguments.output is not None:
        writer(arguments.output, (".json",))
    limit = LONGEST if arguments.limit is None else arguments.limit
    theorem = load(arguments.file).prove(settings(arguments.settings), limit=limit, progress=_said_to_a_terminal)
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
        from gks.bounds.proving import checked_region
        from gks.solvers.march import march

        return _shown(audit_catalogue(march, checked_region, _said_to_a_terminal), arguments)
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


def _report(arguments: Namespace) -> str:
    from gks.reports.command import report_pages

    pages = report_pages(
        arguments.files, arguments.folder, arguments.formats, paper=arguments.paper, fresh=arguments.fresh
    )
    return "\n".join(pages)


def _fuzz(arguments: Namespace) -> str:
    from gks.campaigns.conduct import Conduct
    from gks.campaigns.fuzz import fuzz
    from gks.campaigns.rate import Rate
    from gks.files import write_text

    writers = {path: writer(path, (".csv", ".json")) for path in arguments.outputs}
    if not os.path.isdir(arguments.save):
        raise InputError(f"no folder {quoted(arguments.save)}", path="--save", mend="make it first")
    conduct = Conduct(arguments.jobs, arguments.scheduler, None, arguments.resume, Rate("schemes"))
    result = fuzz(arguments.count, arguments.seed, conduct)
    for name, text in result.minimal_schemes().items():
        write_text(os.path.join(arguments.save, name), text)
    for path, write in writers.items():
        write(result, path)
    return "\n".join(writers) if writers and not arguments.json else _shown(result, arguments)


def _bench(arguments: Namespace) -> str:
    from gks.reports.bench import PICTURED, bench, save_picture

    name: str = arguments.table
    endings = (".csv", ".json", *((".png", ".svg", ".pdf") if name in PICTURED else ()))

    def draw(table: Any, path: str) -> None:
        save_picture(name, table, path)

    writers = {path: writer(path, endings, draw) for path in arguments.outputs}
    table = bench(name, _said_to_a_terminal)
    for path, write in writers.items():
        write(table, path)
    return "\n".join(writers) if writers and not arguments.json else _shown(table, arguments)


_COMMANDS: dict[str, Callable[[Namespace], str]] = {
    "list": _list,
    "new": _new,
    "derive": _derive,
    "modes": _modes,
    "profile": _profile,
    "roots": _roots,
    "curve": _curve,
    "prove": _prove,
    "check": _check,
    "audit": _audit,
    "march": _march,
    "fuzz": _fuzz,
    "bench": _bench,
    "report": _report,
}
