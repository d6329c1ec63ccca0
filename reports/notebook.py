"""Curves and maps that show themselves as pictures in a notebook; everything else about them is their own."""

from __future__ import annotations

from dataclasses import fields
from typing import overload

from gks.bounds.curve import Curve
from gks.bounds.curvemap import CurveMap
from gks.bounds.radius import RadiusMap


class PicturedCurve(Curve):
    """A `Curve` with the representations that notebooks ask for."""

    __slots__ = ()

    def _repr_svg_(self) -> str:
        return _svg(self)

    def _repr_png_(self) -> bytes:
        return _png(self)


class PicturedMap(CurveMap):
    """A `CurveMap` with them."""

    __slots__ = ()

    def _repr_svg_(self) -> str:
        return _svg(self)

    def _repr_png_(self) -> bytes:
        return _png(self)


class PicturedRadius(RadiusMap):
    """A `RadiusMap` with them."""

    __slots__ = ()

    def _repr_svg_(self) -> str:
        return _svg(self)

    def _repr_png_(self) -> bytes:
        return _png(self)


@overload
def pictured(result: Curve) -> PicturedCurve: ...
@overload
def pictured(result: CurveMap) -> PicturedMap: ...
@overload
def pictured(result: RadiusMap) -> PicturedRadius: ...
def pictured(result: Curve | CurveMap | RadiusMap) -> PicturedCurve | PicturedMap | PicturedRadius:
    """The same result, as one that shows itself."""
    content = {field.name: getattr(result, field.name) for field in fields(result)}
    if isinstance(result, CurveMap):
        return PicturedMap(**content)
    return PicturedRadius(**content) if isinstance(result, RadiusMap) else PicturedCurve(**content)


def _svg(result: Curve | CurveMap | RadiusMap) -> str:
    from gks.reports.maps import picture

    return picture(result, "svg").decode("utf-8")


def _png(result: Curve | CurveMap | RadiusMap) -> bytes:
    from gks.reports.maps import picture

    return picture(result, "png")
