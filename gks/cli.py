"""The ``gks`` command: parse the arguments, call the library, print what it gives.

Exit status: 0 it worked, whatever the verdict; 2 the input is at fault (one message on standard error, nothing on
standard output); 1 anything else; 130 interrupted. Only the argument parser is imported before a command is known.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys

import gks

TYPE_CHECKING = False  # as in gks/__init__.py
if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType
    from typing import NoReturn

REPORT_AT = "the project's issue tracker, with the scheme file and the command"


class _Parser(argparse.ArgumentParser):
    """An argument parser whose complaint is one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; see `{self.prog} --help`\n")


class _Commands:
    """Adds the commands, each with the arguments that it shares with others."""

    def __init__(self, commands: argparse._SubParsersAction[_Parser]) -> None:
        self._commands = commands

    def plain(self, name: str, purpose: str, *, file: bool = True, json: bool = True) -> argparse.ArgumentParser:
        """A command of that name: FILE and --json unless it has no use for them."""
        sentence = purpose[0].upper() + purpose[1:] + "."
        sub = self._commands.add_parser(name, help=purpose, description=sentence, allow_abbrev=False)
        sub.set_defaults(command=name)
        if file:
            sub.add_argument("file", metavar="FILE", help="a scheme file, or the name of a shipped scheme")
        if json:
            sub.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
        return sub

    def parametrised(self, name: str, purpose: str) -> argparse.ArgumentParser:
        """One that takes parameter values too."""
        sub = self.plain(name, purpose)
        sub.add_argument(
            "-p",
            action="append",
            default=[],
            metavar="NAME=VALUE",
            dest="settings",
            help="set a parameter, exactly: 9/10, 0.9, 1e-10 (may be repeated)",
        )
        return sub

    def timed(self, sub: argparse.ArgumentParser) -> argparse.ArgumentParser:
        """Lets a command be told when to give up."""
        sub.add_argument("--limit", type=_seconds, metavar="SECONDS", help="give up if it takes longer (default: 600)")
        return sub

    def bounded(self, sub: argparse.ArgumentParser) -> None:
        """Lets a command be told how long to try, and what counts as an answer."""
        sub.add_argument(
            "--limit", type=_seconds, metavar="SECONDS", help="undecided if a point takes longer (default: 60)"
        )
        sub.add_argument("--certify", action="store_true", help="undecided unless it is proved throughout")

    def spread(self, sub: argparse.ArgumentParser) -> None:
        """Lets a long command run on several workers, and go on after it was ended."""
        sub.add_argument("--jobs", type=_count, metavar="N", help="share it among N processes (default: this one)")
        sub.add_argument("--scheduler", metavar="ADDRESS", help="share it among Dask's workers: tcp://HOST:PORT")
        sub.add_argument(
            "--resume", metavar="DIR", help="keep finished chunks in the folder DIR, and go on from those that it holds"
        )

    def written(self, sub: argparse.ArgumentParser, endings: str) -> None:
        """Lets a command write files instead of printing."""
        sub.add_argument("-o", action="append", default=[], metavar="OUT", dest="outputs", help=endings)


def parser() -> argparse.ArgumentParser:
    """The parser of the whole command line; `command` names the function of `gks.commands` that carries it out."""
    top = _Parser(
        prog="gks",
        description="Stability of boundary and interface closures of difference schemes, by normal modes.",
        epilog="FILE is a scheme file, or the name of a shipped scheme (see `gks list`).",
        allow_abbrev=False,
    )
    top.add_argument("--version", action="version", version=f"gks {gks.__version__}")
    command = _Commands(top.add_subparsers(title="commands", metavar="COMMAND", required=True))
    for group in (_files, _modes, _regions, _trials, _pages):  # in the order of --help
        group(command)
    return top


def _files(command: _Commands) -> None:
    """Which schemes there are, and a new one."""
    command.plain("list", "the shipped schemes", file=False)
    new = command.plain("new", "write a commented scheme file to start from", file=False, json=False)
    new.add_argument("name", metavar="NAME", help="the file to write, .toml added if missing; never overwrites")


def _modes(command: _Commands) -> None:
    """The polynomial, its roots, and the modes that they are."""
    command.timed(command.parametrised("derive", "the characteristic polynomial and how its roots map to z"))
    command.bounded(command.parametrised("modes", "the normal modes and the verdict at one set of parameter values"))
    profile = command.parametrised("profile", "what a normal mode looks like in space, on both sides of the boundary")
    profile.add_argument(
        "--mode", type=_place, default=0, metavar="K", help="the mode, by its place in `gks modes` from 0 (default: 0)"
    )
    profile.add_argument("--cells", type=_count, metavar="N", help="points a side (default: until the mode has faded)")
    command.written(command.timed(profile), _PICTURE_OUTPUT)
    roots = command.parametrised("roots", "where the roots z move as a parameter runs, and what they are")
    roots.add_argument("--sweep", required=True, metavar=_SWEEP, help="the parameter that runs")
    command.written(command.timed(roots), _PICTURE_OUTPUT)


def _regions(command: _Commands) -> None:
    """Where a scheme is stable: computed, proved, verified, and held against what is claimed."""
    curve = command.parametrised("curve", "the largest stable CFL number and all stable intervals, over a parameter")
    curve.add_argument(
        "--sweep",
        action="append",
        default=[],
        metavar=_SWEEP,
        help="a parameter that runs, e.g. alpha=1e-4:1e4:401:log (twice: a map; the CFL number: the modes' moduli)",
    )
    command.written(curve, _PICTURE_OUTPUT)
    command.bounded(curve)
    command.spread(curve)
    prove = command.parametrised("prove", "the stable region over a parameter, as a theorem with a certificate")
    command.timed(prove).add_argument(
        "-o", metavar="OUT", dest="output", help="write the certificate to OUT, a .json file"
    )
    check = command.plain("check", "verify a certificate with code that the prover does not share", file=False)
    command.timed(check).add_argument("file", metavar="CERTIFICATE", help="a file that `gks prove -o` wrote")
    audit = command.plain("audit", "the claims of a scheme file, held against what is derived", file=False)
    audit.add_argument("file", metavar="FILE", nargs="?", help="a scheme file, or the name of a shipped scheme")
    audit.add_argument("--all", action="store_true", help="audit every shipped scheme instead, as one table; no limit")
    command.timed(audit)


def _trials(command: _Commands) -> None:
    """What is tried out: random interfaces, and marches."""
    fuzz = command.plain("fuzz", "random interfaces, each judged by independent routes", file=False)
    fuzz.add_argument("--count", type=_count, default=1000, metavar="N", help="how many (default: 1000)")
    fuzz.add_argument("--seed", type=_place, default=0, metavar="S", help="what they are drawn from (default: 0)")
    command.spread(fuzz)
    fuzz.add_argument(
        "--save", default=".", metavar="DIR", help="the folder for the minimal scheme of a disagreement (default: this)"
    )
    command.written(fuzz, _TABLE_OUTPUT)
    march = command.parametrised("march", "growth per step observed in a march, beside what the modes predict")
    command.timed(march).add_argument(
        "--cells", type=_count, metavar="N", help="cells a side (default: as many as the modes need)"
    )
    march.add_argument("--steps", type=_count, metavar="N", help="steps (default: as many as the growth needs)")


def _pages(command: _Commands) -> None:
    """Reports and measurements."""
    report = command.plain("report", "a page with pictures: all there is to say about a scheme", file=False, json=False)
    report.add_argument("files", metavar="FILE", nargs="*", help="scheme files, or names of shipped schemes")
    report.add_argument("--paper", action="store_true", help="the paper of Banks & Sjögreen redone, instead")
    report.add_argument("-o", metavar="DIR", dest="folder", required=True, help="the folder for the page and its data")
    report.add_argument(
        "--format",
        action="append",
        default=[],
        choices=("html", "md", "tex", "json"),
        dest="formats",
        help="what to write (default: html; may be repeated)",
    )
    report.add_argument("--fresh", action="store_true", help="compute all anew, whatever an earlier run has kept")
    bench = command.plain("bench", "measure this program on this machine", file=False)
    bench.add_argument("table", choices=("speed", "precision", "theorems", "stress", "scale"), help="what to measure")
    command.written(bench, _TABLE_OUTPUT)


_SWEEP = "NAME=LO:HI:COUNT[:log]"
_PICTURE_OUTPUT = "write to OUT instead; its ending says what: .csv .json .png .svg .pdf (may be repeated)"
_TABLE_OUTPUT = "write to OUT instead, a .csv or .json file; for precision .png .svg .pdf too (may be repeated)"


def _count(text: str) -> int:
    """A positive whole number; argparse turns the error into its message."""
    if not (text.isascii() and text.isdigit() and len(text) < 10 and int(text) > 0):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 1 to 999999999")
    return int(text)


def _place(text: str) -> int:
    """A whole number from 0; argparse turns the error into its message."""
    return 0 if text.isascii() and text.isdigit() and not text.strip("0") else _count(text)


def _seconds(text: str) -> float:
    """A positive number of seconds."""
    try:
        seconds = float(text)
    except ValueError:
        seconds = 0.0
    if not 0 < seconds < 1e9:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds above 0")
    return seconds


def main(argv: Sequence[str] | None = None) -> int:
    """Carry out one command line (default: the process's own) and return its exit status."""
    arguments = parser().parse_args(argv)
    from gks.commands import carry_out  # only now: --version and --help end in the line above
    from gks.errors import GksError, InputError

    try:
        _print(carry_out(arguments))
    except InputError as error:
        return _complain(str(error), 2) if error.where else _complain(f"gks: {error}", 2)
    except GksError as error:
        return _complain(f"gks: {error}", 1)
    except BrokenPipeError:
        _let_go_of_stdout()  # the reader has what it wanted and left
        return 1
    except OSError as error:
        _let_go_of_stdout()
        return _complain(f"gks: {error.filename or 'standard output'}: {error.strerror or error}", 1)
    except KeyboardInterrupt:
        return _complain("gks: interrupted", 130)
    return 0


def entry() -> NoReturn:
    """The installed command: as `main`, with one line instead of a traceback where the program itself is at fault."""
    sys.excepthook = _report_own_fault
    # Small matrices in large batches: BLAS threads cost several times what they give (a user's own setting stands).
    for variable in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    # A long curve is millions of small objects and no cycles: collecting at Python's usual pace is a sixth of its time.
    gc.set_threshold(100_000)
    sys.exit(main())


def _print(text: str) -> None:
    """Print and flush, so that a full disk or a reader that left is met here and not at exit."""
    reconfigure = getattr(sys.stdout, "reconfigure", None)
    if reconfigure is not None:
        reconfigure(errors="backslashreplace")  # a terminal without the letter ö still gets the answer
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def _complain(message: str, status: int) -> int:
    reconfigure = getattr(sys.stderr, "reconfigure", None)
    if reconfigure is not None:
        reconfigure(errors="backslashreplace")
    print(message, file=sys.stderr)
    return status


def _let_go_of_stdout() -> None:
    """Point standard output at nothing: what is still in its buffer would be written, and fail, once more at exit."""
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (OSError, ValueError):
        return  # no descriptor behind it (a test's capture): nothing is left to write either


def _report_own_fault(kind: type[BaseException], fault: BaseException, trace: TracebackType | None) -> None:
    """`sys.excepthook` of the command: Python then exits with status 1."""
    if os.environ.get("GKS_TRACEBACK") == "1":
        sys.__excepthook__(kind, fault, trace)
        return
    if issubclass(kind, KeyboardInterrupt):  # in the moment before `main` could see to it
        print("gks: interrupted", file=sys.stderr)
        return
    detail = " ".join(str(fault).split())[:500]
    what_to_do = f"GKS_TRACEBACK=1 shows the traceback; please report it to {REPORT_AT}"
    print(f"gks: internal error: {kind.__name__}: {detail} ({what_to_do})", file=sys.stderr)
