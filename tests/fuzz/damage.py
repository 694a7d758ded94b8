"""How files are damaged: the same damage for the same generator."""

from __future__ import annotations

import re

import numpy as np

NUMBERS = (
    b"0 -1 1e9 1e10 1e38 -3e38 1e300 -1e308 1e-300 1e-30 nan inf 1e999 2147483648 4294967295 -9223372036854775808 "
    b"99999999999999999999 1.5 0x10 1_0"
).split()
WORDS = (
    b"{ } x xs k a p pp tt ttp tpa m s c l la lamp i v f fm camera swing transl rot scale /dev/zero ../../x .. "
    b'/proc/self/environ \x1b[31m # null [] {} "" true element property list f v vt'
).split()
_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_WORD = re.compile(rb"[^\s,:\[\]{}]+")


def damaged(data: bytes, rng: np.random.Generator) -> bytes:
    """The file with one to six damages."""
    for _ in range(rng.integers(1, 7)):
        data = _DAMAGES[rng.integers(len(_DAMAGES))](data, rng)
    return data


def _other_number(data: bytes, rng: np.random.Generator) -> bytes:
    return _exchanged(data, _NUMBER, NUMBERS, rng)


def _other_word(data: bytes, rng: np.random.Generator) -> bytes:
    return _exchanged(data, _WORD, WORDS, rng)


def _exchanged(data: bytes, what: re.Pattern[bytes], by: list[bytes], rng: np.random.Generator) -> bytes:
    found = list(what.finditer(data))
    if not found:
        return data
    one = found[rng.integers(len(found))]
    return data[: one.start()] + by[rng.integers(len(by))] + data[one.end() :]


def _cut(data: bytes, rng: np.random.Generator) -> bytes:
    return data[: rng.integers(len(data) + 1)]


def _gap(data: bytes, rng: np.random.Generator) -> bytes:
    at = int(rng.integers(len(data) + 1))
    return data[:at] + data[at + int(rng.integers(1, 40)) :]


def _twice(data: bytes, rng: np.random.Generator) -> bytes:
    at, end = sorted(rng.integers(len(data) + 1, size=2))
    return data[:end] + data[at:]


def _bytes(data: bytes, rng: np.random.Generator) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.integers(1, 5)):
        if changed:
            changed[rng.integers(len(changed))] = rng.integers(256)
    return bytes(changed)


def _word32(data: bytes, rng: np.random.Generator) -> bytes:
    """A number of a binary file, which may be a count, an offset or a coordinate."""
    at = 4 * int(rng.integers(len(data) // 4 + 1))
    extreme = (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7F800000, 0x7FC00000, 0x7F7FFFFF)
    return data[:at] + int(extreme[rng.integers(len(extreme))]).to_bytes(4, "little") + data[at + 4 :]


def _line(data: bytes, rng: np.random.Generator) -> bytes:
    """One of the first lines with words left out, given twice or in another order, as in the head of a PLY file."""
    lines = data.split(b"\n")
    at = int(rng.integers(min(len(lines), 30)))
    words = lines[at].split()
    chosen = rng.integers(max(len(words), 1), size=rng.integers(len(words) + 2)) if words else ()
    return b"\n".join([*lines[:at], b" ".join(words[k] for k in chosen), *lines[at + 1 :]])


_DAMAGES = (_other_number, _other_number, _other_number, _other_word, _cut, _gap, _twice, _bytes, _word32, _line)
