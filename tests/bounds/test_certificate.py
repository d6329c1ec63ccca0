"""Certificates: true ones are accepted, altered ones are not, even where the digest is made to fit."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.bounds.check import check
from gks.bounds.checknumbers import digest
from gks.bounds.proving import prove_here
from gks.catalogue import find
from gks.scheme.schemefile import parse_scheme
from tests.bounds.theorem_schemes import LEAPFROG_OUTFLOW, interface
from tests.examples import examples

TRUE = [
    "traditional-1",
    "traditional-2",
    "average-1",
    "implicit-1",
    "weighted-1",
    "weighted-2",
    "lax-wendroff",
    "outflow",
]

Json = Any


@cache
def certificate_text(name: str) -> str:
    scheme = (
        interface(name)
        if name == "lax-wendroff"
        else parse_scheme(LEAPFROG_OUTFLOW, name)
        if name == "outflow"
        else find(name)
    )
    return json.dumps(prove_here(scheme, {}, lambda stage: None).certificate)


@pytest.mark.parametrize("name", TRUE)
def test_a_certificate_is_accepted(name: str) -> None:
    found = check(json.loads(certificate_text(name)))
    assert found.accepted, found.problem


def leaves(value: Json, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(value, dict | list):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(item, (*path, key))
    else:
        yield path


def altered(value: Json, pick: int) -> Json:
    """One number, sign or word changed."""
    if value is None:
        return [1, "stable", "0"][pick % 3]
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + (1 if pick % 2 else -1)
    if isinstance(value, float):
        return value * (1 + 2.0**-50) if value else 1e-300
    digits = list(re.finditer(r"\d+", value))
    signs = [k for k, c in enumerate(value) if c in "+-*/"]
    if digits and (pick % 3 or not signs):
        here = digits[pick % len(digits)]
        return value[: here.start()] + str(int(here[0]) + 1 + pick % 7) + value[here.end() :]
    if signs:
        k = signs[pick % len(signs)]
        return value[:k] + {"+": "-", "-": "+", "*": "/", "/": "*"}[value[k]] + value[k + 1 :]
    return {"stable": "neutral", "neutral": "generalized", "unstable": "stable", "oo": "5"}.get(value, value + "x")


@examples(500)
@given(
    name=st.sampled_from(["traditional-1", "weighted-1", "implicit-1", "outflow"]),
    place=st.integers(0),
    pick=st.integers(0, 1000),
)
def test_an_altered_certificate_is_rejected_even_with_its_digest_made_to_fit(name: str, place: int, pick: int) -> None:
    content = json.loads(certificate_text(name))
    paths = [path for path in leaves(content) if path[0] not in ("scheme", "name", "digest")]
    path = paths[place % len(paths)]
    holder = content
    for key in path[:-1]:
        holder = holder[key]
    holder[path[-1]] = altered(holder[path[-1]], pick)
    content["digest"] = digest(content)
    assert not check(content).accepted


@pytest.mark.parametrize("entry", ["cells", "cuts", "curves", "walls", "pieces"])
def test_a_certificate_that_lacks_something_is_rejected(entry: str) -> None:
    whole = json.loads(certificate_text("average-1"))
    for k in range(len(whole[entry])):
        less = copy.deepcopy(whole)
        del less[entry][k]
        less["digest"] = digest(less)
        assert not check(less).accepted


def test_a_changed_scheme_is_told_by_the_digest() -> None:
    content = json.loads(certificate_text("traditional-1"))
    content["scheme"] = content["scheme"].replace("0.9", "0.8")
    assert check(content).problem == "the certificate was altered after it was written"


@pytest.mark.parametrize("content", [{}, {"schema": "gks.certificate/1"}, {"schema": 5, "digest": []}])
def test_what_is_no_certificate_is_rejected_without_an_exception(content: Json) -> None:
    assert not check(content).accepted
