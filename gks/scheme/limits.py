"""Every fixed limit on what a scheme file may ask for, and the meter that keeps reading it quick.

All of them are counts, never clock times, so that a file is accepted or refused alike on every machine.
"""

from __future__ import annotations

from gks.errors import TooLarge

# The file as a whole.
MAX_FILE_BYTES = 1_000_000
MAX_TOML_NESTING = 20  # brackets and braces within each other; the format needs three
MAX_KEY_PARTS = 20  # parts of a dotted key or table header; the format needs three. tomllib is quadratic in them
MAX_ENTRIES = 50_000  # parts of keys, values and array elements
MAX_PARAMETERS = 200  # parameters, each a variable of exact polynomials
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

# All formulas of a file together, in nanoseconds as measured on one 2020s core, to within a factor of two. What a
# step costs stands here or, where it depends on sizes, beside the step.
MAX_WORK = 700_000_000
TOKEN_WORK = 12_000  # reading one token, and building its part of an expression
TERM_WORK = 8_000  # adding or scaling one grid value's coefficient
DIGIT_WORK = 6  # reading a number, for each bit of it
MULTIPLY_WORK = 0.00125  # one product, quotient or gcd of integers, times the square of their bits


class Work:
    """Adds up the work that a file asks for; TooLarge once it is over the limit."""

    def __init__(self) -> None:
        self._spent = 0.0

    def spend(self, work: float) -> None:
        self._spent += work
        if self._spent > MAX_WORK:
            raise TooLarge("the formulas of this file are together too long or too large to be read")
