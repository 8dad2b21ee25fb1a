"""Damage to bytes, drawn by a `random.Random`: bits, cuts, splices, numbers out of range, tokens said twice."""

import re
import struct
from random import Random

NUMBER = re.compile(rb"(?<![\w.])-?\d+\.?\d*(?:[eE][-+]?\d+)?(?!\w)")
TOKEN = re.compile(rb"[^\s,;<>\[\]{}]+")
EXTREMES = [
    b"nan",
    b"NaN",
    b"inf",
    b"-inf",
    b"Infinity",
    b"-1",
    b"0",
    b"-0",
    b"1",
    b"2147483648",
    b"4294967295",
    b"-2147483648",
    b"9223372036854775808",
    b"1e308",
    b"-1e308",
    b"1e999",
    b"1e38",
    b"1e-320",
    b"1e-12",
    b"3.5",
    b"255",
    b"65536",
    b"100000000",
    b"0x10",
    b"",
]
WHOLE = [-1, 0, 1, 2, 127, 255, 256, 65535, 2**24, 2**30, 2**31 - 1, 2**31, 2**32 - 1, 2**62, 2**63 - 1, 2**63, 2**64 - 1]
REAL = [float("nan"), float("inf"), -float("inf"), 1e308, -1e308, 1e38, 1e-320, 1e-12, 0.0, -0.0, -1.0, 1e9]


def mutated(data: bytes, random: Random, most: int = 4) -> bytes:
    """``data`` after one to ``most`` changes, mostly one."""
    for _ in range(random.choice((1, 1, random.randint(1, most)))):
        data = random.choice(WAYS)(data, random)
    return data


def _flip(data: bytes, random: Random) -> bytes:
    out = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 8)) if out else 0):
        out[random.randrange(len(out))] ^= 1 << random.randrange(8)
    return bytes(out)


def _cut(data: bytes, random: Random) -> bytes:
    return data[: random.randrange(len(data) + 1)]


def _piece(data: bytes, random: Random) -> tuple[int, int]:
    at = random.randrange(len(data) + 1)
    return at, min(len(data), at + random.choice((1, 2, 4, 12, 50, 400)))


def _splice(data: bytes, random: Random) -> bytes:
    """A piece goes elsewhere, over what is there or between."""
    start, end = _piece(data, random)
    at = random.randrange(len(data) + 1)
    return data[:at] + data[start:end] + data[at + random.choice((0, end - start)) :]


def _drop(data: bytes, random: Random) -> bytes:
    start, end = _piece(data, random)
    return data[:start] + data[end:]


def _number(data: bytes, random: Random) -> bytes:
    """A number in the text becomes an extreme one."""
    found = list(NUMBER.finditer(data))
    if not found:
        return _binary(data, random)
    match = random.choice(found)
    return data[: match.start()] + random.choice(EXTREMES) + data[match.end() :]


def _binary(data: bytes, random: Random) -> bytes:
    """Bytes become an extreme number, whole or real."""
    kind = random.choice("BHIQfd")
    if kind in "fd":
        value = random.choice(REAL)
        packed = struct.pack("<" + kind, value if kind == "d" or abs(value) < 3e38 or value != value else 3e38)
    else:
        size = struct.calcsize(kind)
        packed = (random.choice(WHOLE) % 256**size).to_bytes(size, random.choice(("little", "big")))
    at = random.randrange(len(data) + 1)
    at -= at % random.choice((1, 4))
    return data[:at] + packed + data[at + len(packed) :]


def _token(data: bytes, random: Random) -> bytes:
    """A word is said again: right there, or instead of another."""
    found = list(TOKEN.finditer(data))
    if not found:
        return data
    word, place = random.choice(found).group(), random.choice(found)
    if random.random() < 0.5:
        return data[: place.start()] + word + data[place.end() :]
    return data[: place.end()] + b" " * random.randint(0, 1) + place.group() * random.choice((1, 1, 2, 300)) + data[place.end() :]


def _line(data: bytes, random: Random) -> bytes:
    lines = data.split(b"\n")
    at = random.randrange(len(lines))
    return b"\n".join(lines[:at] + [lines[random.randrange(len(lines))]] * random.choice((1, 1, 40)) + lines[at:])


WAYS = (_flip, _flip, _cut, _splice, _splice, _drop, *[_number] * 5, _binary, _binary, *[_token] * 3, _line)
