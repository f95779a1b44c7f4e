# SPDX-License-Identifier: Apache-2.0
"""Number types for the algorithms: exact, of any mantissa size, or with products fused into additions."""
import math
import operator
from fractions import Fraction

import numpy as np

np.seterr(all="ignore")


class Root:
    """p + q sqrt(m), exact; not a number if p is None. m is the argument of the run's only square root."""

    __slots__ = ("p", "q", "m")

    def __init__(self, p, q=0, m=0):
        self.p, self.q, self.m = p, q, m

    def __add__(self, o):
        return Root(None) if self.p is None or o.p is None else Root(self.p + o.p, self.q + o.q, self.m or o.m)

    def __sub__(self, o):
        return self + -o

    def __neg__(self):
        return self if self.p is None else Root(-self.p, -self.q, self.m)

    def __mul__(self, o):
        if self.p is None or o.p is None:
            return Root(None)
        m = self.m or o.m
        if not self.q and not o.q:
            return Root(self.p * o.p, 0, m)
        return Root(self.p * o.p + self.q * o.q * m, self.p * o.q + self.q * o.p, m)

    def __truediv__(self, o):
        if self.p is None or o.p is None or not (o.p or o.q):
            return Root(None)  # the algorithms divide by zero only in 0 / 0
        norm = o.p * o.p - o.q * o.q * o.m
        return self * Root(Fraction(o.p) / norm, Fraction(-o.q) / norm, o.m)

    def sqrt(self):
        if self.p is None:
            return self
        assert not self.q and not self.m, "a second square root"
        f = Fraction(self.p)
        n, d = math.isqrt(f.numerator), math.isqrt(f.denominator)
        return (
            Root(Fraction(n, d))
            if n * n == f.numerator and d * d == f.denominator
            else Root(Fraction(0), Fraction(1), f)
        )

    def sign(self):
        sp, sq = (self.p > 0) - (self.p < 0), (self.q > 0) - (self.q < 0)
        if sp * sq >= 0:
            return sp or sq
        square = self.p * self.p - self.q * self.q * self.m
        return sp * ((square > 0) - (square < 0))

    def number(self):
        """The number as a Fraction with a relative error of at most 2^-100."""
        if not self.q:
            return Fraction(self.p)
        bits = 200
        while True:
            scaled = self.m * Fraction(4) ** bits
            root = Fraction(math.isqrt(scaled.numerator // scaled.denominator), 2**bits)
            value = self.p + self.q * root
            if value and abs(self.q) < abs(value) * Fraction(2) ** (bits - 100):
                return value
            bits *= 2


def floor_log2(n, d):
    e = n.bit_length() - d.bit_length()
    return e if (n >= d << e if e >= 0 else n << -e >= d) else e - 1


def rounded(x, bits, lowest=None):
    """The Fraction x rounded to `bits` bits, with ties to even. If `lowest` is given, the result is a multiple of 2^lowest."""
    if not x:
        return x
    n, d = x.numerator, x.denominator
    q = floor_log2(abs(n), d) - bits + 1
    if lowest is not None:
        q = max(q, lowest)
    n, d = (n, d << q) if q >= 0 else (n << -q, d)
    whole, rest = divmod(n, d)
    whole += 2 * rest > d or (2 * rest == d and whole % 2)
    return Fraction(whole << q) if q >= 0 else Fraction(whole, 1 << -q)


class Real:
    """Reals in formats that numpy lacks: with a mantissa of `bits` bits, with or without exponent limits."""

    __slots__ = ("v",)  # a Fraction, or nan or inf as a float
    bits, upper, lower = 24, None, None

    def __init__(self, v):
        self.v = v

    @classmethod
    def made(cls, x):
        x = rounded(x, cls.bits, cls.lower)
        if cls.upper is not None and abs(x) >= cls.upper:
            return cls(math.inf if x > 0 else -math.inf)
        return cls(x)

    def _special(self, o, operation):
        return type(self)(getattr(np.float64(signed(self.v)), operation)(np.float64(signed(o.v))).item())

    def finite(self):
        return not isinstance(self.v, float)

    def __add__(self, o):
        return self.made(self.v + o.v) if self.finite() and o.finite() else self._special(o, "__add__")

    def __sub__(self, o):
        return self.made(self.v - o.v) if self.finite() and o.finite() else self._special(o, "__sub__")

    def __mul__(self, o):
        return self.made(self.v * o.v) if self.finite() and o.finite() else self._special(o, "__mul__")

    def __truediv__(self, o):
        if self.finite() and o.finite() and o.v:
            return self.made(Fraction(self.v) / o.v)
        return self._special(o, "__truediv__").settled()

    def settled(self):
        return self if isinstance(self.v, float) and not math.isfinite(self.v) else type(self)(Fraction(0))

    def __neg__(self):
        return type(self)(-self.v)

    def sqrt(self):
        if not self.finite():
            return type(self)(math.sqrt(self.v) if self.v > 0 else math.nan)
        if self.v <= 0:
            return type(self)(Fraction(0))
        shift = 4 * self.bits + max(0, -floor_log2(self.v.numerator, self.v.denominator))
        scaled = self.v * Fraction(4) ** shift
        n = scaled.numerator // scaled.denominator
        root = math.isqrt(n)
        sticky = root * root != scaled
        return self.made(Fraction(2 * root + sticky, 2) / Fraction(2) ** shift)

    def fma(self, o, r):
        if not (self.finite() and o.finite()):
            return self * o + r
        return self.made(self.v * o.v + r.v) if r.finite() else r


def signed(v):
    """A float of the same sign, which numpy accepts."""
    return v if isinstance(v, float) else float((v > 0) - (v < 0))


def fma(a, b, c):
    """a b + c, rounded once."""
    if isinstance(a, Real):
        return a.fma(b, c)
    if not (np.isfinite(a) and np.isfinite(b) and a and b):
        return a * b + c
    if not np.isfinite(c):
        return c
    (na, da), (nb, db), (nc, dc) = (float(x).as_integer_ratio() for x in (a, b, c))
    top, bottom = na * nb * dc + nc * da * db, da * db * dc
    try:
        value = top / bottom  # Python rounds the quotient of two integers only once
    except OverflowError:
        value = math.inf if top > 0 else -math.inf
    if isinstance(a, np.float32) and math.isfinite(value):  # rounds to odd, so that the second rounding is harmless
        n, d = value.as_integer_ratio()
        if n * bottom != top * d and math.ldexp(math.frexp(value)[0], 53) % 2 == 0:
            value = math.nextafter(value, math.inf if n * bottom < top * d else -math.inf)
    return type(a)(value)


class Fused:
    """A number of a contracting lane. A product also stores its factors."""

    __slots__ = ("v", "run", "x", "y", "product", "quotient", "scaled")

    def __init__(self, v, run, quotient=False):
        self.v, self.run, self.product, self.quotient, self.scaled = v, run, None, quotient, False

    def _uses(self):
        if self.product is None:
            return 0
        self.run.uses[self.product] += 1
        return self.run.known_uses[self.product] if self.product < len(self.run.known_uses) else 1

    def _choose(self, o):
        left, right = self._uses(), o._uses()
        if self.product is None or o.product is None:
            return -1 if self.product is not None else 1 if o.product is not None else 0
        if self.run.rule == "left":
            return -1
        return 0 if self.scaled and o.scaled else 1 if right < left else -1

    def __add__(self, o):
        which = self._choose(o)
        return Fused(
            fma(self.x, self.y, o.v) if which < 0 else fma(o.x, o.y, self.v) if which > 0 else self.v + o.v, self.run
        )

    def __sub__(self, o):
        which = self._choose(o)
        return Fused(
            fma(self.x, self.y, -o.v) if which < 0 else fma(-o.x, o.y, self.v) if which > 0 else self.v - o.v, self.run
        )

    def __mul__(self, o):
        result = Fused(self.v * o.v, self.run)
        result.x, result.y, result.scaled, result.product = self.v, o.v, o.quotient, len(self.run.uses)
        self.run.uses.append(0)
        return result

    def __truediv__(self, o):
        return Fused(self.v / o.v, self.run, True)

    def __neg__(self):
        return Fused(-self.v, self.run)

    def sqrt(self):
        return Fused(root_of(self.v), self.run)


def root_of(x):
    return np.sqrt(x) if isinstance(x, np.floating) else x.sqrt()


def value_of(x):
    """The value of any kind of number: an int, Fraction or Root, or a float that is not finite."""
    if isinstance(x, Fused):
        x = x.v
    if isinstance(x, Real):
        return x.v
    return x if not isinstance(x, np.floating) else float(x)


RELATIONS = {"<": operator.lt, "<=": operator.le, "==": operator.eq, ">": operator.gt, ">=": operator.ge}


def outcome(left, relation, right):
    if isinstance(left, Root):
        if left.p is None or right.p is None:
            return False
        left, right = (left - right).sign(), 0
    elif isinstance(left, (Fused, Real)):
        left, right = value_of(left), value_of(right)
    return bool(RELATIONS[relation](left, right))
