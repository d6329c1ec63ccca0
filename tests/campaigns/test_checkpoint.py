"""A folder of chunks: what is in it is whole and of this campaign, or it counts as not there."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.campaigns.checkpoint import Folder, folder
from gks.errors import InputError

KEY: dict[str, str | int] = {"campaign": "test/1", "scheme": "abc", "chunks": 3}

RESULT = {"points": [[1.5, "oo", None], [0.1, 2, True]]}


@pytest.fixture
def place(tmp_path: Path) -> Path:
    return tmp_path / "chunks"


def open_folder(place: Path, key: dict[str, str | int] = KEY) -> Folder:
    with folder(str(place), key) as found:
        return found


def test_results_come_back_as_they_were_kept(place: Path) -> None:
    open_folder(place).keep(1, RESULT)
    assert open_folder(place).results(3) == {1: RESULT}


def test_doubles_come_back_to_the_last_bit(place: Path) -> None:
    numbers = [0.1 + 0.2, 5e-324, 1.7976931348623157e308, -0.0]
    open_folder(place).keep(0, numbers)
    assert [x.hex() for x in open_folder(place).results(1)[0]] == [x.hex() for x in numbers]


def test_a_chunk_beyond_those_asked_for_is_left_out(place: Path) -> None:
    open_folder(place).keep(5, RESULT)
    assert open_folder(place).results(3) == {}


@given(data=st.data())
def test_a_torn_or_changed_file_counts_as_not_there(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    place = tmp_path_factory.mktemp("chunks") / "here"
    open_folder(place).keep(0, RESULT)
    file = place / "00000000.json"
    whole = file.read_bytes()
    at = data.draw(st.integers(0, len(whole) - 1))
    if data.draw(st.booleans()):
        file.write_bytes(whole[:at])
    else:
        file.write_bytes(whole[:at] + bytes([whole[at] ^ 1 << data.draw(st.integers(0, 7))]) + whole[at + 1 :])
    assert open_folder(place).results(1) == {}
    file.write_bytes(whole)
    assert open_folder(place).results(1) == {0: RESULT}


def test_a_chunk_under_anothers_number_counts_as_not_there(place: Path) -> None:
    open_folder(place).keep(0, RESULT)
    (place / "00000000.json").rename(place / "00000001.json")
    assert open_folder(place).results(2) == {}


def test_drafts_of_a_killed_run_are_swept(place: Path) -> None:
    open_folder(place)
    (place / ".gks-abcd.json").write_text("{")
    open_folder(place)
    assert sorted(file.name for file in place.iterdir()) == ["campaign.json", "lock"]


@pytest.mark.parametrize("entry", ["campaign", "scheme", "chunks"])
def test_another_campaign_is_refused_and_says_what_differs(place: Path, entry: str) -> None:
    open_folder(place)
    with pytest.raises(InputError, match=f'"{entry}"'):
        open_folder(place, {**KEY, entry: "other"})


def test_a_folder_with_other_files_is_refused_and_left_alone(place: Path) -> None:
    place.mkdir()
    (place / "thesis.tex").write_text("x")
    with pytest.raises(InputError, match="other files"):
        open_folder(place)
    assert {file.name for file in place.iterdir()} <= {"thesis.tex", "lock"}


def test_a_file_is_no_folder(place: Path) -> None:
    place.write_text("x")
    with pytest.raises(InputError, match="not a folder"):
        open_folder(place)


def test_a_campaign_file_that_is_no_json_is_refused(place: Path) -> None:
    place.mkdir()
    (place / "campaign.json").write_text("[1")
    with pytest.raises(InputError, match="can't be read"):
        open_folder(place)


def test_two_runs_in_one_folder_are_refused(place: Path) -> None:
    def second() -> Iterator[None]:
        with folder(str(place), KEY):
            yield

    with folder(str(place), KEY), pytest.raises(InputError, match="another run"):
        next(second())
    assert open_folder(place).results(3) == {}


def test_the_key_is_there_to_be_read(place: Path) -> None:
    open_folder(place)
    assert json.loads((place / "campaign.json").read_text()) == KEY
