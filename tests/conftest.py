"""Settings of the whole suite."""

from hypothesis import settings
from pytest import Config, Item, Parser

# No deadline: the machine's load is not a property of the code. The same examples in every run of the same tests, so
# that a change is judged by what it changes; `--hypothesis-profile=explore` draws others, and `long` 20 times as many.
settings.register_profile("house", deadline=None, print_blob=True, derandomize=True)
settings.register_profile("explore", settings.get_profile("house"), derandomize=False)
settings.register_profile("long", settings.get_profile("explore"), max_examples=2000)
# `brief` is for a second environment, where only what the first can't see matters.
settings.register_profile("brief", settings.get_profile("house"), max_examples=5)
settings.load_profile("house")


def pytest_addoption(parser: Parser) -> None:
    parser.addoption("--one-case", action="store_true", help="of a test with several cases run the first alone")


SHORT = ("scheme", "house")
"""Folders whose tests take milliseconds: they come last, so that two processes end at about the same time."""


def pytest_collection_modifyitems(config: Config, items: list[Item]) -> None:
    items.sort(key=lambda item: item.path.parent.name in SHORT)
    if config.getoption("one_case"):
        first: dict[str, Item] = {}
        others = [item for item in items if first.setdefault(item.nodeid.partition("[")[0], item) is not item]
        config.hook.pytest_deselected(items=others)
        items[:] = first.values()
