"""Output files, written whole or not at all; and input that is not a scheme file."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def whole_file(path: str) -> Iterator[str]:
    """Give the name of a new file beside `path`, with the same ending; it becomes `path` when the block ends well.

    The new file lies in the same folder because only a rename within one file system replaces a file in one step; its
    ending is kept because picture writers go by it. If the block raises, the new file is removed, `path` as it was.
    """
    target = os.path.realpath(path)  # a link stays a link: the file it names is replaced
    descriptor, draft = tempfile.mkstemp(prefix=".gks-", suffix=os.path.splitext(path)[1], dir=os.path.dirname(target))
    os.close(descriptor)
    try:
        yield draft
        os.chmod(draft, 0o666 & ~_umask())
        os.replace(draft, target)
    except BaseException:
        os.unlink(draft)
        raise


def read_bytes(path: str, most: int) -> bytes:
    """The contents of a file of at most so many bytes; InputError if it can't be read or has more."""
    from gks.errors import InputError, quoted

    try:
        with open(path, "rb") as file:
            data = file.read(most + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(f"{quoted(path)} can't be read: {reason}") from None
    if len(data) > most:
        raise InputError(f"{quoted(path)} has over {most} bytes")
    return data


def write_text(path: str, text: str) -> None:
    """Write `text` to `path` as UTF-8 with LF line ends, whole or not at all."""
    with whole_file(path) as draft, open(draft, "w", encoding="utf-8", newline="\n") as file:
        file.write(text)


def write_bytes(path: str, content: bytes) -> None:
    """Write `content` to `path`, whole or not at all."""
    with whole_file(path) as draft, open(draft, "wb") as file:
        file.write(content)


def write_new(path: str, text: str) -> None:
    """Write `text` to a file that must not exist yet (FileExistsError); no half-written file is left behind."""
    with open(path, "x", encoding="utf-8", newline="\n") as file:  # "x": of two runs at once one is refused
        try:
            file.write(text)
            file.flush()
        except BaseException:
            os.unlink(path)
            raise


def _umask() -> int:
    """The permissions new files are denied; mkstemp denies more than the user asked for."""
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
