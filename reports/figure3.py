"""The picture at the top of README, after the paper's Figure 3: ``python -m gks.reports.figure3 docs/figure3.svg``."""

from __future__ import annotations

import sys

SWEEP = "alpha=1e-2:1e3:401:log"
CURVES = {
    "traditional, first order": "traditional-1",
    "traditional, second order": "traditional-2",
    "impedance-weighted": "weighted-1",
}


def draw(path: str) -> None:
    """Write the picture to `path` (.svg, .png or .pdf)."""
    from gks.bounds.curve import curve
    from gks.bounds.sweep import parse_sweep
    from gks.catalogue import find
    from gks.reports.figures import save_comparison

    schemes = {label: find(name) for label, name in CURVES.items()}
    curves = {label: curve(scheme, scheme.values(), parse_sweep(SWEEP)) for label, scheme in schemes.items()}
    save_comparison(curves, path, "Interface of two elastic media, first-order upwind inside")


if __name__ == "__main__":
    draw(sys.argv[1])
