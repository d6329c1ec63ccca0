"""What the tests of reports share: the example's report, made once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.reports.example import written

Report = tuple[Path, dict[str, str], dict[str, Any]]


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Report:
    """The folder, the pages by format, and the record."""
    folder = tmp_path_factory.mktemp("report")
    return folder, *written(folder, "html", "md", "tex", "json")
