"""Random numbers without a generator's state: hashes of names before a run, hashes of counters during a run.

Before a run, `uniform` and `normal` return a number that is a hash of (seed, variant, stream), so that a variant's
draws depend neither on the other variants nor on their order. A step uses no generator: `random_hash` is a function of
(seed, stream, entity, step) in masked integers, with the same bits interpreted and compiled.
"""

from __future__ import annotations

import operator
from functools import lru_cache
from hashlib import blake2b
from math import cos, log, sqrt, tau
from typing import TYPE_CHECKING, SupportsIndex

from scenario_compiler.marker import compiled

if TYPE_CHECKING:
    from statistics import NormalDist


def whole_number(name: str, value: SupportsIndex) -> int:
    """Return a seed or a count of any type, such as NumPy's, as an int; TypeError for anything but a whole number."""
    try:
        return operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is a whole number, not {value!r}") from None


def hash_bits(seed: int, variant: int, stream: str) -> int:
    """Return 64 bits for a stream of a variant."""
    name = f"{seed}/{variant}/{stream}".encode()
    return int.from_bytes(blake2b(name, digest_size=8).digest(), "big")


def uniform(seed: int, variant: int, stream: str) -> float:
    """Return a number in the open interval (0, 1), one of 2**52."""
    return ((hash_bits(seed, variant, stream) >> 12) + 0.5) / 4503599627370496.0


def normal(seed: int, variant: int, stream: str) -> float:
    """Return a standard normal number: the quantile of `uniform` (Wichura 1988, AS 241, in `statistics`)."""
    return _standard_normal().inv_cdf(uniform(seed, variant, stream))


@lru_cache(maxsize=1)
def _standard_normal() -> NormalDist:
    from statistics import NormalDist

    return NormalDist()


@compiled
def mix_bits(value: int) -> int:
    """Return 32 bits that depend on every bit of a 32-bit value (two multiplications, after T. Mueller's integer hash).

    The factors are below 2**31, so that no product exceeds 63 bits.
    """
    bits = ((value >> 16) ^ value) * 73244475 & 0xFFFFFFFF
    bits = ((bits >> 16) ^ bits) * 73244475 & 0xFFFFFFFF
    return (bits >> 16) ^ bits


@compiled
def random_hash(seed: int, stream: int, entity: int, step: int) -> int:
    """Return 32 bits for one draw during a run; all arguments are taken modulo 2**32."""
    bits = mix_bits((seed & 0xFFFFFFFF) ^ 0x3C6EF372)
    bits = mix_bits((bits + (stream & 0xFFFFFFFF) * 40503) & 0xFFFFFFFF)
    bits = mix_bits((bits + (entity & 0xFFFFFFFF) * 69069) & 0xFFFFFFFF)
    return mix_bits((bits + (step & 0xFFFFFFFF) * 1664525) & 0xFFFFFFFF)


@compiled
def random_unit(seed: int, stream: int, entity: int, step: int) -> float:
    """Return a number in (0, 1) for one draw during a run."""
    return (random_hash(seed, stream, entity, step) + 0.5) / 4294967296.0


@compiled
def random_normal(seed: int, stream: int, entity: int, step: int) -> float:
    """Return a standard normal number for one draw during a run (Box and Muller 1958), from two `random_unit`."""
    first = random_unit(seed, stream, entity, 2 * step)
    second = random_unit(seed, stream, entity, 2 * step + 1)
    return sqrt(max(-2.0 * log(max(first, 1.0e-12)), 0.0)) * cos(tau * second)
