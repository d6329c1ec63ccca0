"""Wave speeds and their characteristic variables by projectors. Part of the checker."""

from __future__ import annotations

from gks.bounds.checkring import GEN, ONE, Fr, Unsupported, constant, determinant, factors, parts_of


def spectrum(flux: list[list[Fr]]) -> list[tuple[Fr, list[tuple[Fr, ...]]]]:
    """Eigenvalues with independent columns of their projectors prod (A - w')/(w - w')."""
    size = len(flux)
    characteristic = determinant([[(_diagonal(i, j) - flux[i][j]) for j in range(size)] for i in range(size)])
    values = []
    for factor, multiplicity in factors(characteristic.num):
        parts = parts_of(factor, "x")
        if len(parts) == 2:
            values.append((Fr.of(-parts[0], parts[1]), multiplicity))
        elif len(parts) > 2:
            raise Unsupported("wave speeds that are no rational functions")
    found = []
    for value, multiplicity in values:
        projector = [[constant(int(i == j)) for j in range(size)] for i in range(size)]
        for other, _ in values:
            if other != value:
                shifted = [[flux[i][j] - (other if i == j else constant(0)) for j in range(size)] for i in range(size)]
                projector = [
                    [
                        sum((projector[i][k] * shifted[k][j] for k in range(size)), constant(0)) / (value - other)
                        for j in range(size)
                    ]
                    for i in range(size)
                ]
        columns = _independent([tuple(projector[i][j] for i in range(size)) for j in range(size)])
        if len(columns) != multiplicity:
            raise Unsupported("a flux without a full set of eigenvectors")
        found.append((value, columns))
    return found


def _diagonal(i: int, j: int) -> Fr:
    return Fr(GEN["x"], ONE) if i == j else constant(0)


def _independent(columns: list[tuple[Fr, ...]]) -> list[tuple[Fr, ...]]:
    chosen: list[tuple[Fr, ...]] = []
    reduced: list[tuple[Fr, ...]] = []
    for column in columns:
        rest = column
        for basis in reduced:
            lead = next(k for k, v in enumerate(basis) if not v.zero)
            factor = rest[lead] / basis[lead]
            rest = tuple(a - factor * b for a, b in zip(rest, basis, strict=True))
        if any(not v.zero for v in rest):
            chosen.append(column)
            reduced.append(rest)
    return chosen
