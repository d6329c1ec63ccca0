"""``python -m gks``: the same as the ``gks`` command."""

from gks.cli import entry

if __name__ == "__main__":
    entry()
