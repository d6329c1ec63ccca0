"""The library as a notebook uses it: load a scheme, ask for its modes, its curve, its characteristic polynomial.

Results are the analyses' own objects: they print as the command prints them, and `to_json()` gives its JSON object.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from numbers import Real
from typing import TYPE_CHECKING, TypeVar, cast

from gks.errors import ParameterError, TooLarge, quoted

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from gks.bounds.audit import Audit
    from gks.bounds.rootpaths import RootMap
    from gks.bounds.sweep import Sweep
    from gks.bounds.theorem import Theorem
    from gks.modes import ModesResult
    from gks.modes.derivation import Derivation
    from gks.modes.profile import Profile
    from gks.reports.notebook import PicturedCurve, PicturedMap, PicturedRadius
    from gks.scheme.model import Scheme
    from gks.solvers.march import MarchResult

Value = Fraction | int | str | float | Decimal
"""A parameter's value, exact: a fraction, an integer, text ("9/10", "1e-10"), or a float, the decimal it prints."""

Sweepable = Value | Iterable[Value]
"""A value, or the values a parameter runs through: an array or a list, or text as in --sweep ("1e-4:1e4:401:log")."""

V = TypeVar("V")


def load(name_or_path: str | os.PathLike[str]) -> LoadedScheme:
    """The shipped scheme of that name, or the one in that file; InputError if it is neither or the file is at fault."""
    from gks.catalogue import find

    return LoadedScheme(find(name_or_path))


@dataclass(frozen=True, slots=True)
class LoadedScheme:
    """A scheme with its analyses as methods.

    Each takes parameter values by name, `modes(lam="9/10", alpha=5)`, or as a mapping, which also reaches parameters
    whose names Python keeps for itself, `modes({"lambda": "9/10"})`. Parameters not given take the file's defaults.
    ParameterError for a value or a name that is not one; NotAnalysable where an analysis does not apply to the scheme.
    """

    scheme: Scheme

    def modes(
        self,
        values: Mapping[str, Value] | None = None,
        /,
        *,
        limit: float | None = None,
        certify: bool = False,
        **named: Value,
    ) -> ModesResult:
        """The normal modes and the verdict at one set of parameter values.

        What takes over `limit` seconds is undecided, and with `certify` also what is not proved.
        """
        exact = self.scheme.values(_merged(values, named))
        if limit is None and not certify:
            from gks.modes import analyse

            return analyse(self.scheme, exact)
        from gks.bounds.verdicts import verdict_within

        return verdict_within(self.scheme, exact, limit=limit, certify=certify)

    def profile(
        self, values: Mapping[str, Value] | None = None, /, *, mode: int = 0, cells: int | None = None, **named: Value
    ) -> Profile:
        """What a mode looks like in space: the one of that place in `modes` (0: the largest modulus), so many cells."""
        from gks.modes.profile import profile

        return profile(self.modes(_merged(values, named)), mode, cells)

    def roots(
        self, values: Mapping[str, Sweepable] | None = None, /, *, sweep: str | None = None, **named: Sweepable
    ) -> RootMap:
        """Where the roots z move as one parameter runs: given as an array, as text with colons, or by `sweep`."""
        from gks.bounds.rootmap import rootmap
        from gks.bounds.sweep import parse_sweep

        fixed, sweeps = _split(_merged(values, named))
        if sweep is not None:
            sweeps.append(parse_sweep(sweep))
        if len(sweeps) != 1:
            raise ParameterError(f"{len(sweeps)} parameters run", expected="one that does")
        return rootmap(self.scheme, self.scheme.values(fixed), sweeps[0])

    def derive(self, values: Mapping[str, Value] | None = None, /, **named: Value) -> Derivation:
        """The characteristic polynomial, factored, and the map of its roots to z; parameters not given stay symbols."""
        from gks.modes.derivation import derive

        given = _merged(values, named)
        free = [p.name for p in self.scheme.parameters if p.name not in given]
        return derive(self.scheme, self.scheme.values(given, free))

    def curve(
        self,
        values: Mapping[str, Sweepable] | None = None,
        /,
        *,
        sweep: str | Sequence[str] = (),
        jobs: int | None = None,
        scheduler: str | None = None,
        executor: Executor | None = None,
        resume: str | None = None,
        progress: Callable[[int, int], None] | None = None,
        limit: float | None = None,
        certify: bool = False,
        **named: Sweepable,
    ) -> PicturedCurve | PicturedMap | PicturedRadius:
        """The largest stable CFL number and all stable intervals: over one parameter, two, or at the one point given.

        A parameter that runs is given as an array, as text with colons, or by `sweep` as on the command line. Where the
        CFL number itself runs, the result is the largest modulus of the modes, in one piece and in double precision.
        A point that takes over `limit` seconds is flagged as undecided, and with `certify` also one that is not proved
        throughout.
        A sweep may be shared by `jobs` processes, the workers of a Dask `scheduler` ("tcp://..."), or any `executor` of
        concurrent.futures, and may keep its finished chunks in the folder `resume`: a run that was ended goes on from
        there, and the points are the same bytes either way. `progress` is told points done, of how many.
        """
        from gks.bounds.sweep import parse_sweep
        from gks.bounds.sweeping import swept
        from gks.reports.notebook import pictured

        fixed, sweeps = _split(_merged(values, named))
        sweeps += map(parse_sweep, [sweep] if isinstance(sweep, str) else sweep)
        exact = self.scheme.values(fixed)
        shared = not (jobs is None and scheduler is None and executor is None and resume is None)
        if any(each.name == self.scheme.cfl for each in sweeps) and (shared or certify or limit is not None):
            raise ParameterError(
                f"over {quoted(self.scheme.cfl)} the modes' moduli are found in one piece, in double precision",
                path="--sweep",
                mend="leave out --jobs, --scheduler, --resume, --limit and --certify",
            )
        if not shared:
            return pictured(swept(self.scheme, exact, sweeps, progress, limit=limit, certify=certify))
        from gks.campaigns.conduct import Conduct
        from gks.campaigns.sweeps import campaign_curve

        conduct = Conduct(jobs, scheduler, executor, resume, progress)
        return pictured(campaign_curve(self.scheme, exact, sweeps, conduct, limit=limit, certify=certify))

    def prove(
        self,
        values: Mapping[str, Value] | None = None,
        /,
        *,
        limit: float | None = None,
        progress: Callable[[str], None] | None = None,
        **named: Value,
    ) -> Theorem:
        """The stable region over the ranged parameter not given, proved; others not given take their defaults.

        The CFL number takes no value: it is what the theorem bounds.

        ``limit`` in seconds; ``progress`` is told the stages. What cannot be proved says why and carries the curve.
        """
        from gks.bounds.proof import prove

        given = _merged(values, named)
        if self.scheme.cfl in given:
            raise ParameterError("it is what the theorem bounds", path=self.scheme.cfl, mend="leave it out")
        free = [p.name for p in self.scheme.parameters if p.name not in given]
        return prove(self.scheme, self.scheme.values(given, free), limit, progress)

    def audit(self) -> Audit:
        """The file's claims held against what is derived; a march stands beside each claim that fails."""
        from gks.bounds.audit import audit
        from gks.bounds.proving import checked_region
        from gks.solvers.march import march

        return audit(self.scheme, march, checked_region)

    def march(
        self,
        values: Mapping[str, Value] | None = None,
        /,
        *,
        cells: int | None = None,
        steps: int | None = None,
        **named: Value,
    ) -> MarchResult:
        """Predicted against observed growth per step; cells a side and steps are chosen where they aren't given."""
        from gks.solvers.march import march

        return march(self.scheme, self.scheme.values(_merged(values, named)), cells, steps)

    def __str__(self) -> str:
        scheme = self.scheme
        lines = [scheme.title, scheme.source]
        for parameter in scheme.parameters:
            default = "no default" if parameter.default is None else parameter.default
            lines.append(f"  {parameter.name} = {default}" + (f"  ({parameter.doc})" if parameter.doc else ""))
        return "\n".join(line for line in lines if line)


def _merged(values: Mapping[str, V] | None, named: Mapping[str, V]) -> dict[str, V]:
    return {**(values or {}), **named}


def _split(values: Mapping[str, Sweepable]) -> tuple[dict[str, Value], list[Sweep]]:
    """The values that stand and the sweeps, told apart by their type (and text by its colons)."""
    from gks.bounds.sweep import parse_sweep

    fixed: dict[str, Value] = {}
    sweeps: list[Sweep] = []
    for name, value in values.items():
        if isinstance(value, str) and ":" in value:
            sweeps.append(parse_sweep(f"{name}={value}"))
        elif isinstance(value, str | Decimal | Real):  # Real: numpy's scalars too
            fixed[name] = cast(Value, value)
        else:
            sweeps.append(_array(name, cast(Iterable[Value], value)))
    return fixed, sweeps


def _array(name: str, values: Iterable[Value]) -> Sweep:
    """The sweep over an array's values, each exact as a single value is; ParameterError for one that isn't a number."""
    from gks.bounds.sweep import of_values
    from gks.scheme.numbers import rational

    try:
        exact = [value if isinstance(value, Fraction) else rational(str(value)) for value in values]
    except (ValueError, TooLarge) as error:
        raise ParameterError(str(error), path=name, expected="an array of finite numbers") from None
    if not exact:
        raise ParameterError("the array is empty", path=name, expected="at least one value")
    return of_values(name, exact)
