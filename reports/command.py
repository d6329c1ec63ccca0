"""`gks report`: which reports are asked for, and where their pages are."""

from __future__ import annotations

import os
from collections.abc import Sequence

from gks.errors import InputError, quoted
from gks.reports.report import scheme_report, stem_of
from gks.reports.watch import Progress


def report_pages(
    files: Sequence[str], folder: str, formats: Sequence[str], *, paper: bool = False, fresh: bool = False
) -> list[str]:
    """Write the reports of these schemes, or the paper's, into the folder; the paths of the pages.

    InputError where neither or both are asked for, before anything is computed.
    """
    from gks.catalogue import find

    if paper == bool(files):
        found = f"both --paper and {quoted(files[0])}" if files else "nothing to report on"
        raise InputError(found, expected="expected scheme files, or --paper")
    wanted = list(dict.fromkeys(formats)) or ["html"]
    if os.path.exists(folder) and not os.path.isdir(folder):
        raise InputError(f"-o {quoted(folder)} is a file", expected="expected the name of a folder")
    if paper:
        from gks.reports.paper import paper_report

        return paper_report(folder, Progress("paper"), wanted, fresh=fresh)
    schemes = [find(file) for file in files]
    pages, taken = [], set[str]()
    for scheme in schemes:
        stem = stem_of(scheme)
        number = 2
        while stem.lower() in taken:  # two files of one name from two folders
            stem = f"{stem_of(scheme)}-{number}"
            number += 1
        taken.add(stem.lower())
        pages += scheme_report(scheme, folder, Progress(stem), wanted, fresh=fresh, stem=stem)
    return pages
