"""What a user reads when the input is at fault: one line with place, found, expected and mend."""

from __future__ import annotations

import pickle

from gks.errors import ParameterError, SchemeError, Where, counted, one_line, quoted


def test_the_message_is_one_line_with_all_its_parts() -> None:
    error = SchemeError(
        "found 3",
        where=Where("half_step.toml", 14, 9),
        path="closure.equations[2]",
        expected="expected 4",
        mend="add one",
    )
    assert str(error) == "half_step.toml:14:9: closure.equations[2]: found 3; expected 4; add one"


def test_missing_parts_leave_no_gaps() -> None:
    assert str(ParameterError("found 3")) == "found 3"
    assert str(ParameterError("found 3", path="lam", mend="add one")) == "lam: found 3; add one"
    assert str(SchemeError("is a directory", where=Where("here"))) == "here: is a directory"


def test_user_text_stays_on_one_line_and_short() -> None:
    assert one_line("a\nb\x1b[31m\u202e\ud800") == r"a\nb\x1b[31m\u202e\ud800"
    assert quoted("x" * 100, 21) == '"' + "x" * 9 + "..." + "x" * 9 + '"'
    assert "\n" not in str(SchemeError("a\nb", path="c\nd"))
    assert len(str(SchemeError("9" * 10_000, expected="8" * 10_000))) < 1200


def test_errors_survive_pickling() -> None:
    error = SchemeError("found", where=Where("f", 1, 2), path="a", expected="b", mend="c")
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is SchemeError and str(copy) == str(error) and copy.where == error.where


def test_counting() -> None:
    assert [counted(n, "row") for n in (0, 1, 2)] == ["0 rows", "1 row", "2 rows"]
