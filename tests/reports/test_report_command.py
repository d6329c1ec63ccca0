"""`gks report` on the command line: what it prints, what it refuses before computing anything."""

from pathlib import Path

import pytest

from gks.cli import main
from tests.reports.example import TEXT


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-o", "out"], "nothing to report on"),
        (["traditional-1", "--paper", "-o", "out"], "both --paper and"),
        (["nosuch", "-o", "out"], "neither a file nor a shipped scheme"),
        (["traditional-1", "nosuch", "-o", "out"], "neither a file nor a shipped scheme"),
        (["traditional-1", "-o", "file"], "is a file"),
    ],
)
def test_what_is_at_fault_is_said_in_one_line(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    assert main(["report", *arguments]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert words in said.err
    assert said.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("arguments", [["traditional-1"], ["traditional-1", "-o", "out", "--format", "docx"]])
def test_the_folder_is_needed_and_the_format_known(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["report", *arguments])
    assert ended.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_it_prints_the_paths_of_the_pages_and_tells_progress(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "one.toml").write_text(TEXT, encoding="utf-8")
    assert main(["report", "a/one.toml", "b/one.toml", "-o", "out", "--format", "json"]) == 0
    said = capsys.readouterr()
    assert said.out.split() == ["out/one.json", "out/one-2.json"]  # two files of one name do not overwrite each other
    assert all(Path(path).is_file() for path in said.out.split())
    assert "one: theorem" in said.err
    assert "so far" in said.err
    assert "kept from an earlier run" in said.err  # the same scheme a second time
    assert not list(Path("out").glob("*.html"))
