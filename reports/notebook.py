"""A curve that shows itself as a picture in a notebook; everything else about it is the curve's own."""

from __future__ import annotations

from dataclasses import fields

from gks.bounds.curve import Curve


class PicturedCurve(Curve):
    """A `Curve` with the representations that notebooks ask for."""

    __slots__ = ()

    def _repr_svg_(self) -> str:
        from gks.reports.figures import curve_svg

        return curve_svg(self)

    def _repr_png_(self) -> bytes:
        from gks.reports.figures import curve_png

        return curve_png(self)


def pictured(curve: Curve) -> PicturedCurve:
    """The same curve, as one that shows itself."""
    return PicturedCurve(**{field.name: getattr(curve, field.name) for field in fields(curve)})
