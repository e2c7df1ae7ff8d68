#!/usr/bin/env python3
"""Recomputes every line of the FP24 vectors, without the program that wrote them.

    python3 oracle.py [FOLDER]          all files of FOLDER/manifest.json (default: this folder)
    python3 oracle.py [FOLDER] FILE...  only these

Needs Python 3.8 and nothing else. A float is taken apart into an exact rational number, the
operation is done on rationals, and the result is rounded by comparing it with its two
neighbours, as docs/numerics.md defines it. No host float takes part.

Exit code: 0 every line agrees, 1 some line differs, 2 it could not be told (a file or an entry
is missing, or nothing was compared).
"""

import hashlib
import json
import math
import os
import sys
from fractions import Fraction

INEXACT, UNDERFLOW, OVERFLOW, DIVIDE_BY_ZERO, INVALID = 1, 2, 4, 8, 16


class Format:
    """A float of one sign, E exponent and F fraction bits."""

    def __init__(self, name):
        exponent_bits, fraction_bits = name[1:].split("f")
        self.E, self.F = int(exponent_bits), int(fraction_bits)
        self.width = 1 + self.E + self.F
        self.bias = (1 << (self.E - 1)) - 1
        self.sign_bit = 1 << (self.E + self.F)
        self.infinity = ((1 << self.E) - 1) << self.F
        self.quiet_nan = self.infinity | 1 << (self.F - 1)
        self.least_exponent = 1 - self.bias
        self.smallest_normal = Fraction(2) ** self.least_exponent
        self.largest = (2 - Fraction(1, 1 << self.F)) * Fraction(2) ** self.bias


class Operand:
    """What a pattern stands for: exactly one of nan, infinite, or a rational value."""

    def __init__(self, bits, format, policy):
        self.negative = bits & format.sign_bit != 0
        magnitude = bits & (format.sign_bit - 1)
        field, fraction = magnitude >> format.F, magnitude & ((1 << format.F) - 1)
        self.nan = magnitude > format.infinity
        self.signalling = self.nan and fraction >> (format.F - 1) == 0
        self.infinite = magnitude == format.infinity
        self.value = None
        if not self.nan and not self.infinite:
            unit = Fraction(2) ** (max(field, 1) - format.bias - format.F)
            self.value = (fraction + ((1 << format.F) if field else 0)) * unit
            if field == 0 and policy == "flush":
                self.value = Fraction(0)
            if self.negative:
                self.value = -self.value
        self.zero = self.value == 0

    def key(self):
        """Where it stands on the number line, infinities beyond all numbers."""
        if self.infinite:
            return (-1 if self.negative else 1, Fraction(0))
        return (0, self.value)


def binary_exponent(magnitude):
    """The e with 2^e <= magnitude < 2^(e+1)."""
    e = magnitude.numerator.bit_length() - magnitude.denominator.bit_length()
    return e if Fraction(2) ** e <= magnitude else e - 1


def to_neighbour(quotient, negative, rounding, tail=0):
    """A magnitude in units rounded to an integer; `tail`: it is that much (nothing, or too little
    to count) above `quotient`. Returns the integer and whether it is exact."""
    lower = math.floor(quotient)
    rest = quotient - lower
    if rest == 0 and not tail:
        return lower, True
    if rounding == "rne":
        half = Fraction(1, 2)
        up = rest > half or (rest == half and (tail or lower % 2 == 1))
    elif rounding == "rtz":
        up = False
    else:
        up = negative == (rounding == "rdn")
    return lower + (1 if up else 0), False


def encode(magnitude, negative, format):
    """The pattern of a number the format holds exactly."""
    sign = format.sign_bit if negative else 0
    if magnitude == 0:
        return sign
    exponent = max(binary_exponent(magnitude), format.least_exponent)
    units = magnitude / Fraction(2) ** (exponent - format.F)
    assert units.denominator == 1
    # The leading one of a normal number adds one to a field that is one too low.
    field = exponent - format.least_exponent
    return sign | (field << format.F) + units.numerator


def rounded(magnitude, negative, format, rounding, policy, tail=0):
    """A nonzero result as a pattern, with its flags."""
    sign = format.sign_bit if negative else 0
    unit = Fraction(2) ** (binary_exponent(magnitude) - format.F)
    units, exact = to_neighbour(magnitude / unit, negative, rounding, tail)
    unbounded = units * unit
    if unbounded > format.largest:
        away = rounding == "rne" or (rounding == "rdn" if negative else rounding == "rup")
        result = format.infinity if away else format.infinity - 1
        return sign | result, OVERFLOW | INEXACT
    if unbounded >= format.smallest_normal:
        return encode(unbounded, negative, format), 0 if exact else INEXACT
    if policy == "flush":
        return sign, UNDERFLOW | INEXACT
    unit = Fraction(2) ** (format.least_exponent - format.F)
    units, exact = to_neighbour(magnitude / unit, negative, rounding, tail)
    return encode(units * unit, negative, format), 0 if exact else UNDERFLOW | INEXACT


def invalid_if(condition):
    return INVALID if condition else 0


def total(exact, zero_negative, format, rounding, policy):
    """A sum: rounded, or a zero of this sign."""
    if exact == 0:
        return (format.sign_bit if zero_negative else 0), 0
    return rounded(abs(exact), exact < 0, format, rounding, policy)


def add(a, b, format, rounding, policy):
    if a.nan or b.nan:
        return format.quiet_nan, invalid_if(a.signalling or b.signalling)
    if a.infinite and b.infinite and a.negative != b.negative:
        return format.quiet_nan, INVALID
    if a.infinite or b.infinite:
        negative = a.negative if a.infinite else b.negative
        return format.infinity | (format.sign_bit if negative else 0), 0
    zero_negative = rounding == "rdn"
    if a.zero and b.zero and a.negative == b.negative:
        zero_negative = a.negative
    return total(a.value + b.value, zero_negative, format, rounding, policy)


def sub(a, b, format, rounding, policy):
    b.negative = not b.negative
    if b.value is not None:
        b.value = -b.value
    return add(a, b, format, rounding, policy)


def mul(a, b, format, rounding, policy):
    if a.nan or b.nan:
        return format.quiet_nan, invalid_if(a.signalling or b.signalling)
    if (a.infinite and b.zero) or (a.zero and b.infinite):
        return format.quiet_nan, INVALID
    negative = a.negative != b.negative
    sign = format.sign_bit if negative else 0
    if a.infinite or b.infinite:
        return sign | format.infinity, 0
    if a.zero or b.zero:
        return sign, 0
    return rounded(abs(a.value * b.value), negative, format, rounding, policy)


def div(a, b, format, rounding, policy):
    if a.nan or b.nan:
        return format.quiet_nan, invalid_if(a.signalling or b.signalling)
    if (a.infinite and b.infinite) or (a.zero and b.zero):
        return format.quiet_nan, INVALID
    negative = a.negative != b.negative
    sign = format.sign_bit if negative else 0
    if a.infinite:
        return sign | format.infinity, 0
    if b.zero:
        return sign | format.infinity, DIVIDE_BY_ZERO
    if a.zero or b.infinite:
        return sign, 0
    return rounded(abs(a.value / b.value), negative, format, rounding, policy)


def sqrt(a, format, rounding, policy):
    if a.nan:
        return format.quiet_nan, invalid_if(a.signalling)
    if a.zero:
        return (format.sign_bit if a.negative else 0), 0
    if a.negative:
        return format.quiet_nan, INVALID
    if a.infinite:
        return format.infinity, 0
    # Scaled by an even power of two until the integer root has far more bits than are kept; what
    # is left over is less than one unit of it, and only whether it is nothing matters.
    shift = 2 * (format.F + 4 + format.bias + format.F)
    scaled = a.value * Fraction(2) ** shift
    assert scaled.denominator == 1
    root = math.isqrt(scaled.numerator)
    tail = root * root != scaled.numerator
    return rounded(
        Fraction(root) / Fraction(2) ** (shift // 2), False, format, rounding, policy, tail
    )


def fused_multiply_add(a, b, c, format, rounding, policy):
    signalling = a.signalling or b.signalling or c.signalling
    undefined = (a.infinite and b.zero) or (a.zero and b.infinite)
    if undefined and not signalling:
        # Of 0 * infinity + NaN, IEEE 754-2019 leaves the flag open; here it is raised.
        return format.quiet_nan, INVALID
    if a.nan or b.nan or c.nan:
        return format.quiet_nan, invalid_if(signalling)
    negative = a.negative != b.negative
    if a.infinite or b.infinite:
        if c.infinite and c.negative != negative:
            return format.quiet_nan, INVALID
        return format.infinity | (format.sign_bit if negative else 0), 0
    if c.infinite:
        return format.infinity | (format.sign_bit if c.negative else 0), 0
    product = a.value * b.value
    zero_negative = rounding == "rdn"
    if product == 0 and c.zero and negative == c.negative:
        zero_negative = negative
    return total(product + c.value, zero_negative, format, rounding, policy)


def extremum(largest):
    def operation(a, b, format, rounding, policy):
        flags = invalid_if(a.signalling or b.signalling)
        if a.nan and b.nan:
            return format.quiet_nan, flags
        if a.nan or b.nan:
            chosen = b if a.nan else a
        else:
            # -0 is below +0.
            key = lambda x: (x.key(), not x.negative)
            chosen = max(a, b, key=key) if largest else min(a, b, key=key)
        if chosen.infinite:
            return format.infinity | (format.sign_bit if chosen.negative else 0), flags
        return encode(abs(chosen.value), chosen.negative, format), flags

    return operation


def predicate(holds, signalling):
    """A comparison: false beside a NaN, which is invalid if signalling, or if the NaN is."""

    def operation(a, b, format, rounding, policy):
        if a.nan or b.nan:
            return 0, invalid_if(signalling or a.signalling or b.signalling)
        return int(holds(a.key(), b.key())), 0

    return operation


def unordered(a, b, format, rounding, policy):
    return int(a.nan or b.nan), invalid_if(a.signalling or b.signalling)


def to_integral(says_inexact):
    def operation(a, format, rounding, policy):
        if a.nan:
            return format.quiet_nan, invalid_if(a.signalling)
        sign = format.sign_bit if a.negative else 0
        if a.infinite:
            return sign | format.infinity, 0
        integer, exact = to_neighbour(abs(a.value), a.negative, rounding)
        flags = 0 if exact or not says_inexact else INEXACT
        if integer == 0:
            return sign, flags
        # Where fractions of the largest numbers reach below the point, the integer may be beyond.
        result, beyond = rounded(Fraction(integer), a.negative, format, rounding, policy)
        return result, flags | beyond

    return operation


def to_integer(width, signed, says_inexact):
    least = -(1 << (width - 1)) if signed else 0
    most = (1 << (width - (1 if signed else 0))) - 1
    mask = (1 << width) - 1

    def operation(a, format, rounding, policy):
        if a.nan:
            return 0, INVALID
        if a.infinite:
            return (least if a.negative else most) & mask, INVALID
        integer, exact = to_neighbour(abs(a.value), a.negative, rounding)
        integer = -integer if a.negative else integer
        if not least <= integer <= most:
            return (least if a.negative else most) & mask, INVALID
        return integer & mask, 0 if exact or not says_inexact else INEXACT

    return operation


def from_integer(width, signed):
    def operation(bits, format, rounding, policy):
        negative = signed and bits >> (width - 1) == 1
        magnitude = (1 << width) - bits if negative else bits
        if magnitude == 0:
            return 0, 0
        return rounded(Fraction(magnitude), negative, format, rounding, policy)

    return operation


def convert_to(target):
    def operation(a, format, rounding, policy):
        if a.nan:
            return target.quiet_nan, invalid_if(a.signalling)
        sign = target.sign_bit if a.negative else 0
        if a.infinite:
            return sign | target.infinity, 0
        if a.zero:
            return sign, 0
        return rounded(abs(a.value), a.negative, target, rounding, policy)

    return operation


LESS, LESS_EQUAL, EQUAL = (lambda a, b: a < b), (lambda a, b: a <= b), (lambda a, b: a == b)


def operations(format):
    """Operator name -> (formats of its operands, None for integers; function of the operands, the
    rounding and the policy)."""
    own = [format]

    def in_own_format(operation):
        return lambda *rest: operation(*rest[:-2], format, *rest[-2:])

    table = {
        "add": (own * 2, add),
        "sub": (own * 2, sub),
        "mul": (own * 2, mul),
        "div": (own * 2, div),
        "sqrt": (own, sqrt),
        "fused_multiply_add": (own * 3, fused_multiply_add),
        "min": (own * 2, extremum(False)),
        "max": (own * 2, extremum(True)),
        "unordered_quiet": (own * 2, unordered),
        "round_to_integral": (own, to_integral(False)),
        "round_to_integral_exact": (own, to_integral(True)),
    }
    for name, holds in [("equal", EQUAL), ("less_than", LESS), ("less_equal", LESS_EQUAL)]:
        table[name + "_quiet"] = (own * 2, predicate(holds, False))
        table[name + "_signalling"] = (own * 2, predicate(holds, True))
    for width in (16, 32, 64):
        for prefix, signed in [("i", True), ("u", False)]:
            integer = f"{prefix}{width}"
            table["to_" + integer] = (own, to_integer(width, signed, False))
            table["to_" + integer + "_exact"] = (own, to_integer(width, signed, True))
            table["from_" + integer] = ([None], from_integer(width, signed))
    for other in ("e5f10", "e7f16", "e8f7", "e8f23", "e11f52"):
        table["to_" + other] = (own, convert_to(Format(other)))
        table["from_" + other] = ([Format(other)], convert_to(format))
    return {name: (formats, in_own_format(f)) for name, (formats, f) in table.items()}


def cannot(message):
    print(f"oracle: {message}", file=sys.stderr)
    sys.exit(2)


def check(folder, entry):
    """The lines of a file, and how many of them differ."""
    path = os.path.join(folder, entry["file"])
    try:
        with open(path, "rb") as file:
            data = file.read()
    except OSError as problem:
        cannot(f"{path}: {problem.strerror}; restore it from the repository")
    if hashlib.sha256(data).hexdigest() != entry["sha256"]:
        print(f"{path}: its digest is not the manifest's: it was changed")
        return 0, 1
    format = Format(entry["format"])
    table = operations(format)
    if entry["operator"] not in table:
        cannot(f"{path}: operator {entry['operator']} is not known here")
    operand_formats, operation = table[entry["operator"]]
    rounding, policy = entry["rounding"], entry["policy"]
    differing = 0
    lines = data.decode("ascii").splitlines()
    for number, line in enumerate(lines, 1):
        words = [int(word, 16) for word in line.split()]
        if len(words) != len(operand_formats) + 2:
            cannot(f"{path}:{number}: {len(words)} words where {len(operand_formats) + 2} belong")
        operands = [
            word if operand is None else Operand(word, operand, policy)
            for word, operand in zip(words, operand_formats)
        ]
        result, flags = operation(*operands, rounding, policy)
        if [result, flags] != words[-2:]:
            differing += 1
            if differing <= 5:
                print(f"{path}:{number}: {line}: here it is {result:X} {flags:02X}")
    if len(lines) != entry["lines"]:
        print(f"{path}: {len(lines)} lines, the manifest says {entry['lines']}")
        differing += 1
    return len(lines), differing


def main():
    arguments = sys.argv[1:]
    if any(argument in ("-h", "--help") for argument in arguments):
        print(__doc__)
        return 0
    folder = os.path.dirname(os.path.abspath(__file__))
    if arguments and os.path.isdir(arguments[0]):
        folder = arguments.pop(0)
    manifest = os.path.join(folder, "manifest.json")
    try:
        with open(manifest, encoding="utf-8") as file:
            entries = json.load(file)["files"]
    except (OSError, ValueError, KeyError) as problem:
        cannot(f"{manifest}: {problem!r}; name the folder of the vectors")
    if arguments:
        known = {entry["file"]: entry for entry in entries}
        missing = [name for name in arguments if name not in known]
        if missing:
            cannot(f"{manifest} has no file {missing[0]}")
        entries = [known[name] for name in arguments]
    lines = differing = 0
    for entry in entries:
        compared, wrong = check(folder, entry)
        lines, differing = lines + compared, differing + wrong
    print(f"{lines} lines of {len(entries)} files recomputed, {differing} differ")
    if differing:
        return 1
    if lines == 0:
        cannot("nothing was compared")
    return 0


if __name__ == "__main__":
    sys.exit(main())
