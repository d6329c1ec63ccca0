"""What the tests of reports share: the example's report, made once."""

from __future__ import annotations

import json
import os
import shutil
from fcntl import LOCK_EX, flock
from pathlib import Path
from typing import Any

import pytest

from tests.reports.example import written

Report = tuple[Path, dict[str, str], dict[str, Any]]


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Report:
    """The folder, the pages by format, and the record.

    It takes half a minute, so that of several test processes one makes it: each has a copy of its folder for itself.
    """
    own = tmp_path_factory.getbasetemp()
    common = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
    made, returned = common / "example-report", common / "example-report.json"
    with (common / "example-report.lock").open("w") as lock:
        flock(lock, LOCK_EX)  # let go of when the file is closed
        if not returned.exists():
            returned.write_text(json.dumps(written(made, "html", "md", "tex", "json")), encoding="utf-8")
    folder = tmp_path_factory.mktemp("report") / "copy"
    shutil.copytree(made, folder)
    pages, record = json.loads(returned.read_text(encoding="utf-8"))
    return folder, pages, record
