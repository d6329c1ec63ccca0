"""Jobs for campaigns in tests: functions of a module, as worker processes need them."""

from __future__ import annotations

import os
import time
from pathlib import Path

from gks.errors import InputError


def square(k: int) -> list[int]:
    return [k, k * k]


def slow_square(k: int, seconds: float) -> list[int]:
    time.sleep(seconds)
    return square(k)


def dies_once(k: int, folder: str) -> list[int]:
    """Ends its process at the first try of every third chunk."""
    marker = Path(folder, f"tried-{k}")
    if k % 3 == 0 and not marker.exists():
        marker.touch()
        os._exit(9)
    return square(k)


def dies(k: int) -> list[int]:
    os._exit(9)


def refuses(k: int) -> list[int]:
    if k == 2:
        raise InputError("no such thing", path="here")
    return square(k)


def where(k: int) -> int:
    time.sleep(0.05)
    return os.getpid()
