"""Every fixed limit on what a scheme file may ask for, and the meter that keeps reading it quick.

All of them are counts, never clock times, so that a file is accepted or refused alike on every machine.
"""

from __future__ import annotations

from gks.errors import TooLarge

# The file as a whole.
MAX_FILE_BYTES = 1_000_000
MAX_TOML_NESTING = 20  # brackets and braces within each other; the format needs three
MAX_KEY_PARTS = 20  # parts of a dotted key or table header; the format needs three. tomllib is quadratic in them
MAX_ENTRIES = 50_000  # keys, values and array elements
MAX_NAMES = 200  # parameters, each a variable of exact polynomials
MAX_UNKNOWNS = 16  # of one domain

# One number.
MAX_DIGITS = 4000  # Python itself refuses to read integers of over 4300 digits
MAX_DECIMAL_EXPONENT = 10_000

# One formula.
MAX_NESTING = 200
MAX_EXPONENT = 1000  # of one power
MAX_OFFSET = 64  # in space and in time, and of `first`
MAX_DEGREE = 10_000  # of numerator and denominator multiplied out, in all symbols together
MAX_BITS = 200_000  # of any coefficient multiplied out and of any exact value: 1e300 to the power 200
MAX_WRITTEN = 200_000  # parts of a formula with its shorthands written out

# All formulas of a file together, in nanoseconds that were measured for the steps below (to within a factor of two).
MAX_WORK = 1_000_000_000
TOKEN_WORK = 4_000  # reading one token, and building its part of an expression
TERM_WORK = 1_000  # adding or scaling one grid value's coefficient
TEST_WORK = 30_000  # deciding whether a small formula vanishes
PART_WORK = 30  # the same for a larger one, for each part and 64 bits
DIGIT_WORK = 4  # reading a number, for each bit of it


class Work:
    """Adds up the work that a file asks for; TooLarge once it is over the limit."""

    def __init__(self) -> None:
        self._spent = 0

    def spend(self, work: int) -> None:
        self._spent += work
        if self._spent > MAX_WORK:
            raise TooLarge("the formulas of this file are together too long or too large to be read")
