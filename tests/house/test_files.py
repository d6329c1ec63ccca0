"""An output file is written whole or not at all."""

import os
from pathlib import Path

import pytest

from gks.files import whole_file, write_new, write_text


class Stop(Exception):
    """What happens in the middle of a write."""


def fail_halfway(path: Path) -> None:
    with whole_file(str(path)) as draft:
        Path(draft).write_text("half of it")
        raise Stop


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text("old")
    with pytest.raises(Stop):
        fail_halfway(path)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["curve.csv"]


def test_the_old_file_is_there_until_the_new_one_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text("old")
    with whole_file(str(path)) as draft:
        Path(draft).write_text("new")
        assert path.read_text() == "old"
    assert path.read_text() == "new"


def test_the_draft_has_the_ending_and_the_folder_of_the_file(tmp_path: Path) -> None:
    with whole_file(str(tmp_path / "curve.svg")) as draft:
        assert Path(draft).suffix == ".svg"
        assert Path(draft).parent == tmp_path


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "link.csv").symlink_to("target.csv")
    write_text(str(tmp_path / "link.csv"), "text")
    assert (tmp_path / "link.csv").is_symlink()
    assert (tmp_path / "target.csv").read_text() == "text"


def test_permissions_are_those_of_any_new_file(tmp_path: Path) -> None:
    (tmp_path / "plain").touch()
    write_text(str(tmp_path / "whole"), "text")
    assert (tmp_path / "whole").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_lines_end_in_lf_and_letters_are_utf8(tmp_path: Path) -> None:
    write_text(str(tmp_path / "f"), "ö\n")
    assert (tmp_path / "f").read_bytes() == b"\xc3\xb6\n"


def test_a_new_file_never_replaces_one(tmp_path: Path) -> None:
    path = tmp_path / "scheme.toml"
    write_new(str(path), "first")
    with pytest.raises(FileExistsError):
        write_new(str(path), "second")
    assert path.read_text() == "first"


def test_a_new_file_that_fails_is_removed(tmp_path: Path) -> None:
    with pytest.raises(UnicodeEncodeError):
        write_new(str(tmp_path / "scheme.toml"), "\udcff")
    assert os.listdir(tmp_path) == []
