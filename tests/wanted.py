"""Programs beside Python that some tests need: without them those are skipped, except where they have to be there."""

from __future__ import annotations

import os
import shutil

import pytest

WANTED = os.environ.get("GKS_BROWSER") == "1" or bool(os.environ.get("CI"))
"""Whether what .ci/browser installs has to be there: then its absence is a failure and no reason to skip."""

NEEDS_LATEX = pytest.mark.skipif(
    shutil.which("pdflatex") is None and not WANTED, reason="no pdflatex here; apt-get install texlive-latex-base"
)


def pdflatex() -> str:
    """The program; a test that calls for it fails where it is not there."""
    found = shutil.which("pdflatex")
    assert found is not None, "GKS_BROWSER or CI asks for pdflatex, and there is none"
    return found
