#!/usr/bin/env python3
"""Recomputes every expectation of the hard cases from the definition of a hit, in fractions.

    python3 oracle.py                  all cases beside this program
    python3 oracle.py FILE...          only these
    python3 oracle.py --answers FILE   prints the hit of each ray, for whoever writes a case

Needs Python 3.11 and nothing else. It shares nothing with the golden model: numbers are read
into fractions, all borders that a ray crosses are listed at once and sorted, and the texels are
then taken in that order.

The definition (docs/numerics.md): texels are boxes, looked at in the order in which the ray enters
them. One that is entered at t_in and left at t_out, its top at depth d: if t_in >= d the ray hits its
side, at t_in; else if d <= t_out, its top, at d. A ray on a border belongs to the texel it travels
into, to the right-hand one if it does not move on that axis; through a corner u is crossed first.

Exit code: 0 every expectation agrees, 1 some differ, 2 it could not be told (a file that cannot be
read, or nothing was compared).
"""

import sys
from fractions import Fraction
from math import ceil, floor
from pathlib import Path

CASE_KEYS = {"name", "family", "why", "source", "map", "rays"}
MAP_KEYS = {"bits", "heights", "size", "ground", "texels"}
RAY_KEYS = {"note", "u", "v", "du", "dv", "i", "j", "depth", "on"}


def number(text):
    """A decimal or a hex float, exactly. It must be one that a 64-bit float holds."""
    body = text.lstrip("+-")
    if len(text) - len(body) > 1:
        raise ValueError(f"{text!r} is not a number")
    if body.startswith("0x"):
        digits, _, exponent = body[2:].partition("p")
        whole, _, fraction = digits.partition(".")
        value = Fraction(int(whole + fraction, 16), 16 ** len(fraction))
        value *= Fraction(2) ** int(exponent or 0)
    else:
        value = Fraction(body)
    value = -value if text.startswith("-") else value
    if Fraction(float(value)) != value:
        raise ValueError(f"{text!r} is not exact in 64 bits")
    return value


class Map:
    """Depths of texels, which wrap."""

    def __init__(self, table):
        unknown = table.keys() - MAP_KEYS
        if unknown:
            raise ValueError(f"unknown key in [map]: {sorted(unknown)}")
        self.full = (1 << table["bits"]) - 1
        if "heights" in table:
            self.rows = table["heights"]
            self.size = len(self.rows)
            self.ground, self.raised = None, {}
        else:
            self.rows, self.size, self.ground = None, table["size"], table["ground"]
            self.raised = {(i, j): height for i, j, height in table["texels"]}

    def depth(self, i, j):
        height = self.rows[j][i] if self.rows else self.raised.get((i, j), self.ground)
        return Fraction(self.full - height, self.full)


def borders(position, offset):
    """Depths up to 1 at which a ray crosses texel borders on one axis, in texels, in order; the
    border it starts on is none of them."""
    if offset > 0:
        first, last = floor(position) + 1, floor(position + offset)
        lines = range(first, last + 1)
    elif offset < 0:
        first, last = ceil(position) - 1, ceil(position + offset)
        lines = range(first, last - 1, -1)
    else:
        lines = ()
    return [(line - position) / offset for line in lines]


def start(position, offset):
    """The texel that a ray enters, not wrapped."""
    return ceil(position) - 1 if offset < 0 else floor(position)


def hit(world, u, v, du, dv):
    """The hit: i, j, depth, and what is hit."""
    size = world.size
    p, q, e, f = u * size, v * size, du * size, dv * size
    i, j = start(p, e), start(q, f)
    # Sorted by depth; of equal depths, u before v.
    events = [(t, 0) for t in borders(p, e)] + [(t, 1) for t in borders(q, f)]
    events.sort()
    t_in = Fraction(0)
    for t_out, axis in events + [(None, None)]:
        depth = world.depth(i % size, j % size)
        if t_in >= depth:
            return i % size, j % size, t_in, "side"
        if t_out is None or depth <= t_out:
            return i % size, j % size, depth, "top"
        if axis == 0:
            i += 1 if e > 0 else -1
        else:
            j += 1 if f > 0 else -1
        t_in = t_out


def read(path):
    """A case of the corpus."""
    import tomllib

    case = tomllib.loads(path.read_text(encoding="utf-8"))
    unknown = case.keys() - CASE_KEYS
    for ray in case["rays"]:
        unknown |= ray.keys() - RAY_KEYS
    if unknown:
        raise ValueError(f"unknown key: {sorted(unknown)}")
    return case


def answer(world, ray):
    u, v, du, dv = (number(ray[key]) for key in ("u", "v", "du", "dv"))
    return hit(world, u, v, du, dv)


def main(arguments):
    wants_answers = arguments[:1] == ["--answers"]
    names = arguments[1:] if wants_answers else arguments
    own = Path(__file__).resolve().parent
    paths = [Path(name) for name in names] or sorted(own.glob("*.toml"))
    rays = differences = 0
    for path in paths:
        try:
            case = read(path)
            world = Map(case["map"])
            for number_of_ray, ray in enumerate(case["rays"], 1):
                i, j, depth, on = answer(world, ray)
                if wants_answers:
                    print(f'i = {i}\nj = {j}\ndepth = "{depth}"\non = "{on}"\n')
                    rays += 1
                    continue
                expected = (ray["i"], ray["j"], Fraction(ray["depth"]), ray["on"])
                rays += 1
                if expected != (i, j, depth, on):
                    differences += 1
                    print(
                        f"{path.name}, ray {number_of_ray}: expected {expected[0]}, {expected[1]} at "
                        f"{expected[2]} on the {expected[3]}; by the definition {i}, {j} at {depth} "
                        f"on the {on}"
                    )
        except (OSError, KeyError, ValueError, ImportError) as problem:
            print(f"oracle.py: {path}: {problem!r}", file=sys.stderr)
            return 2
    if rays == 0:
        print("oracle.py: nothing was compared", file=sys.stderr)
        return 2
    if not wants_answers:
        print(f"{rays} rays of {len(paths)} cases, {differences} differ")
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
