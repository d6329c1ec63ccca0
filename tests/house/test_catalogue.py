"""The shipped schemes are what their sources define.

The closures are written out by hand from the paper, so they are held here against what physics makes true of them, not
against a second copy: a state that satisfies the interface conditions passes, to the order claimed; the weighted and
the characteristic couplings answer an outgoing wave on one side with none on the other.
"""

from collections.abc import Callable
from fractions import Fraction

import pytest

from gks import catalogue
from gks.scheme.model import GridValue, Scheme

PAPER = "Banks & Sjögreen, eq"
EVERY = catalogue.names()
NAMES = [name for name in EVERY if catalogue.find(name).source.startswith(PAPER)]
FIRST_ORDER = [name for name in NAMES if "-1" in name]
SECOND_ORDER = [name for name in NAMES if "-2" in name]
STEEP = {"alpha": Fraction(7, 3)}

Field = Callable[[GridValue], Fraction]


def residuals(scheme: Scheme, field: Field) -> list[Fraction]:
    """What each closure equation leaves of a field, exactly."""
    values = scheme.values(STEEP)
    return [
        sum((coefficient.at(values) * field(value) for value, coefficient in equation.form.terms), Fraction(0))
        for equation in scheme.closure.equations
    ]


def ghosts(scheme: Scheme, field: Field) -> dict[str, Fraction]:
    """The ghost values that the closure gives for a field inside: each equation holds one of them."""
    outside = set(scheme.boundary_unknowns)
    inside = residuals(scheme, lambda value: Fraction(0) if value in outside else field(value))
    found = {}
    for equation, rest in zip(scheme.closure.equations, inside, strict=True):
        ((value, coefficient),) = ((v, c) for v, c in equation.form.terms if v in outside)
        found[str(value)] = -rest / coefficient.at({})
    return found


def speeds(scheme: Scheme) -> tuple[dict[str, Fraction], dict[str, Fraction]]:
    """Wave speed c and stiffness kappa of both sides, from the fluxes [[0, -1/rho], [-kappa, 0]]."""
    values = scheme.values(STEEP)
    c, kappa = {}, {}
    for line in scheme.domains:
        assert line.flux is not None
        (zero, by_density), (by_stiffness, zero_too) = ([entry.at(values) for entry in row] for row in line.flux)
        assert zero == zero_too == 0
        kappa[line.name] = -by_stiffness
        square = by_density * by_stiffness
        c[line.name] = next(Fraction(k, 6) for k in range(1, 60) if Fraction(k, 6) ** 2 == square)
    return c, kappa


def position(value: GridValue) -> Fraction:
    """Cell centres: L's cells 0, -1, ... at -1/2, -3/2, ...; R's 0, 1, ... at 1/2, 3/2, ..., the interface at 0."""
    return value.index + (Fraction(1, 2) if value.domain == "R" else Fraction(-1, 2))


@pytest.mark.parametrize("name", EVERY)
def test_every_file_has_title_source_and_claims(name: str) -> None:
    scheme = catalogue.find(name)
    assert scheme.title
    assert scheme.source
    assert scheme.claims
    assert all(claim.source for claim in scheme.claims)


@pytest.mark.parametrize("name", EVERY)
def test_the_list_says_what_the_file_says(name: str) -> None:
    (entry,) = (entry for entry in catalogue.Listing().entries if entry.name == name)
    scheme = catalogue.find(name)
    assert (entry.title, entry.source) == (scheme.title, scheme.source)


@pytest.mark.parametrize("name", NAMES)
def test_the_closure_gives_both_ghost_values_of_both_sides(name: str) -> None:
    unknowns = {str(value) for value in catalogue.find(name).boundary_unknowns}
    assert unknowns == {"L.u[1]", "L.s[1]", "R.u[-1]", "R.s[-1]"}


@pytest.mark.parametrize("name", NAMES)
def test_continuous_constant_states_pass(name: str) -> None:
    """Velocity and stress equal on both sides satisfy the interface conditions, and every closure."""
    constants = {"u": Fraction(3), "s": Fraction(-5)}
    assert residuals(catalogue.find(name), lambda value: constants[value.unknown]) == [0, 0, 0, 0]


def kinked(value: GridValue) -> Fraction:
    """Linear on each side, continuous at the interface, with four different slopes."""
    slope = {"L.u": 2, "L.s": -3, "R.u": 5, "R.s": 7}[f"{value.domain}.{value.unknown}"]
    return 1 + slope * position(value)


@pytest.mark.parametrize("name", SECOND_ORDER)
def test_second_order_closures_pass_linear_states(name: str) -> None:
    """Ghost and cell stand at equal distances from the interface in (3.22), so linear states are reproduced exactly."""
    assert residuals(catalogue.find(name), kinked) == [0, 0, 0, 0]


@pytest.mark.parametrize("name", FIRST_ORDER)
def test_first_order_closures_do_not(name: str) -> None:
    assert all(residual != 0 for residual in residuals(catalogue.find(name), kinked))


def outgoing(scheme: Scheme, left: int, right: int) -> Field:
    """Waves that leave the interface: (c, kappa) into the left side, (-c, kappa) into the right one, halved by cell."""
    c, kappa = speeds(scheme)

    def field(value: GridValue) -> Fraction:
        amplitude = (left if value.domain == "L" else right) * Fraction(1, 2) ** abs(value.index)
        sign = 1 if value.domain == "L" else -1
        return amplitude * (sign * c[value.domain] if value.unknown == "u" else kappa[value.domain])

    return field


def given_back(scheme: Scheme, field: Field) -> tuple[Fraction, Fraction]:
    """The amplitudes a at L's ghost and b at R's ghost of the waves that the closure sends into the sides, by (3.3)."""
    c, kappa = speeds(scheme)
    ghost = ghosts(scheme, field)
    a = ghost["L.u[1]"] / (2 * c["L"]) + ghost["L.s[1]"] / (2 * kappa["L"])
    b = -ghost["R.u[-1]"] / (2 * c["R"]) + ghost["R.s[-1]"] / (2 * kappa["R"])
    return a, b


@pytest.mark.parametrize("name", [name for name in NAMES if name.startswith("weighted")])
def test_impedance_weights_uncouple_the_two_sides(name: str) -> None:
    """The off-diagonal entries of Theorem 3.3's matrix vanish, with unequal speeds too: the weights are for that."""
    scheme = catalogue.find(name)
    assert given_back(scheme, outgoing(scheme, left=0, right=1))[0] == 0
    assert given_back(scheme, outgoing(scheme, left=1, right=0))[1] == 0
    assert given_back(scheme, outgoing(scheme, left=1, right=0))[0] != 0


def test_equal_weights_do_not() -> None:
    scheme = catalogue.find("average-1")
    assert given_back(scheme, outgoing(scheme, left=0, right=1))[0] != 0


@pytest.mark.parametrize(("name", "back"), [("characteristic-1", 0), ("characteristic-2", -1)])
def test_the_characteristic_state_of_two_outgoing_waves_is_zero(name: str, back: int) -> None:
    """Nothing arrives at the interface, so its state is zero: ghosts are 0, or minus the cell where (3.22) reflects."""
    scheme = catalogue.find(name)
    assert given_back(scheme, outgoing(scheme, left=2, right=3)) == (Fraction(2 * back), Fraction(3 * back))


def test_the_mirror_is_the_traditional_coupling_with_sides_exchanged() -> None:
    """Exchange L and R, x and -x (and so the sign of the velocity): the closure equations are the same set."""

    def equations(name: str, mirrored: bool) -> set[frozenset[tuple[str, str]]]:
        def image(value: GridValue) -> str:
            return f"{'RL'['LR'.index(value.domain)]}.{value.unknown}[{-value.index}]" if mirrored else str(value)

        forms = (equation.form for equation in catalogue.find(name).closure.equations)
        return {frozenset((image(value), str(coefficient)) for value, coefficient in form.terms) for form in forms}

    assert equations("traditional-1", mirrored=True) == equations("traditional-1-mirror", mirrored=False)


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("traditional-1", {"1.001012", "0.9989870"}),
        ("traditional-2", {"0.4397", "0.9893", "1.0104"}),
    ],
)
def test_numbers_are_claimed_with_the_digits_printed(name: str, printed: set[str]) -> None:
    """A decimal is held to the digits printed, so the trailing 0 of 0.9989870 counts."""
    texts = {text for claim in catalogue.find(name).claims for text in claim.texts.values()}
    assert printed <= texts
