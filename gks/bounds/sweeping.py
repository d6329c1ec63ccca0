"""What `gks curve` gives for the parameters that run: a curve, a map, or the modes' moduli where lam itself runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from gks.bounds.curve import Curve, Progress, check_sweep, curve
from gks.bounds.sweep import Sweep
from gks.errors import ParameterError, quoted
from gks.scheme.model import Scheme

if TYPE_CHECKING:
    from gks.bounds.curvemap import CurveMap
    from gks.bounds.radius import RadiusMap


def swept(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    sweeps: Sequence[Sweep],
    progress: Progress | None = None,
    *,
    limit: float | None = None,
    certify: bool = False,
) -> Curve | CurveMap | RadiusMap:
    """None runs: the one point; one: a curve; two: a map. Where one of them is the CFL number, the moduli of the modes.

    ParameterError for a sweep that makes no sense; else as `curve`, `curve_map` and `radius_map`.
    """
    if any(each.name == scheme.cfl for each in sweeps):
        return _with_lam(scheme, values, sweeps, progress)
    if len(sweeps) > 1:
        from gks.bounds.curvemap import curve_map

        return curve_map(scheme, values, sweeps, progress, limit=limit, certify=certify)
    return curve(scheme, values, sweeps[0] if sweeps else None, progress, limit=limit, certify=certify)


def _with_lam(
    scheme: Scheme, values: Mapping[str, Fraction], sweeps: Sequence[Sweep], progress: Progress | None
) -> RadiusMap:
    from gks.bounds.radius import radius_map

    others = [each for each in sweeps if each.name != scheme.cfl]
    if len(others) > 1 or len(others) + 1 < len(sweeps):
        raise ParameterError(
            f"{len(sweeps)} sweeps", path="--sweep", expected=f"{quoted(scheme.cfl)} and one other parameter at most"
        )
    for each in others:
        check_sweep(scheme, each)
    (lams,) = (each.values for each in sweeps if each.name == scheme.cfl)
    return radius_map(scheme, values, others[0] if others else None, lams, progress)
