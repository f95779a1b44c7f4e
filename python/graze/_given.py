# SPDX-License-Identifier: Apache-2.0
"""Tests of a function of two triangles, for pytest and unittest."""
import ctypes
import functools
from typing import Any, Callable, Optional

import numpy as np

from graze import _library
from graze._arrays import Pair
from graze._verdict import DECLINED, verdict_of

_RAISED = 3  # the library's number for an exception
_EITHER = ("touching", "coplanar", "degenerate", "shared")


class _Tested:
    """The user's function, called by the library."""

    def __init__(self, function: Callable[..., Any], name: str, vectorized: bool):
        self.function, self.name, self.vectorized = function, name, vectorized
        self.ended_by: Optional[BaseException] = None  # the exception that ends the test
        self.raised: Optional[Exception] = None  # the function's first exception; it counts as a wrong answer

    def of_pairs(self, pairs: np.ndarray) -> np.ndarray:
        if not self.vectorized:
            return np.fromiter((self._of_one(pair) for pair in pairs), np.uint8, len(pairs))
        try:
            answers = np.asanyarray(self.function(pairs[:, 0], pairs[:, 1]))
        except Exception as raised:  # raised for one of the pairs, or for all
            self.raised = self.raised or raised
            if len(pairs) == 1:
                return np.array([_RAISED], np.uint8)
            return np.concatenate([self.of_pairs(half) for half in np.array_split(pairs, 2)])
        answers = _library.unmasked(answers, f"the answers of {self.name}")
        if answers.shape != (len(pairs),) or answers.dtype.kind not in "biu":
            raise TypeError(
                f"the function returns {answers.dtype} of shape {answers.shape}, not {len(pairs)} bools or ints"
            )
        return np.where(answers < 0, DECLINED, answers != 0).astype(np.uint8)

    def _of_one(self, pair: np.ndarray) -> int:
        try:
            answer = self.function(pair[0], pair[1])
        except Exception as raised:
            self.raised = self.raised or raised
            return _RAISED
        return verdict_of(answer, self.name)

    def end(self, failure: BaseException) -> None:
        self.ended_by = failure

    def decide(self, floats: Any, count: int, verdicts: Any) -> int:
        try:
            if self.ended_by:
                return 1
            pairs = np.array(np.ctypeslib.as_array(floats, (count, 2, 3, 3)))
            pairs.flags.writeable = False
            np.ctypeslib.as_array(verdicts, (count,))[:] = self.of_pairs(pairs)
            return 0
        except BaseException as failure:  # raised again after the call, because it cannot pass through the library
            self.ended_by = failure
            return 1


def _words(pair: Pair, fault: str) -> str:
    return (
        f"{fault}.\n  @graze.example('{pair}')\n"
        f"To see it: echo '{pair}' > wrong.pairs; graze check wrong.pairs; graze view wrong.pairs"
    )


def _check(tested: _Tested, name: str, options: _library.Options, examples: list[Pair]) -> Optional[str]:
    """Returns: a message if the function fails; otherwise None."""
    for pair in examples:
        verdict = int(tested.of_pairs(pair.array[np.newaxis])[0])
        _library.call("fault", _library.pointer(pair.array), ctypes.c_uint8(verdict), ctypes.byref(options))
        if _library.text():
            return f"{name} is wrong on an example: {_words(pair, _library.text())}"
    result, decide = _library.Result(), _library.Decide(tested.decide)
    with _library.failures_on_entering(tested.decide, tested.end):
        try:
            _library.call("test", name.encode(), decide, ctypes.byref(options), ctypes.byref(result))
        except KeyboardInterrupt:
            raise tested.ended_by or KeyboardInterrupt
    if tested.ended_by:
        raise tested.ended_by
    if result.passed:
        return None
    summary, _, fault = _library.text().rpartition("\n")
    if not result.has_smallest:
        return summary.strip()
    pair = Pair(np.array(result.smallest, np.float32))
    return summary.rstrip() + "\nThe smallest wrong pair that was found: " + _words(pair, fault)


def given(
    strata: str = "*",
    *,
    pairs: int = 100_000,
    seed: int = 1,
    max_wrong: float = 0.0,
    either: "str | tuple[str, ...]" = (),
    vectorized: bool = False,
) -> Callable[[Callable[..., Any]], Callable[..., None]]:
    """Makes a test of a function or method that takes two triangles, float32 arrays of shape (3, 3), and returns
    whether they intersect; an int below 0 declines. The test draws pairs of the strata and compares the function's
    answers with the exact ones. If too many are wrong, it fails and shows the smallest wrong pair.

    max_wrong: the accepted share of wrong answers.
    either: kinds of pairs on which both answers are accepted: "touching", "coplanar", "degenerate", "shared".
    vectorized: the function takes arrays of shape (n, 3, 3) and returns n answers.
    GRAZE_PAIRS and GRAZE_SEED in the environment, or pytest's --graze-pairs and --graze-seed, override pairs and seed.

    >>> @given("uniform", pairs=100)
    ... def test_boxes(a, b):
    ...     return bool((a.max(0) >= b.min(0)).all() and (b.max(0) >= a.min(0)).all())
    >>> test_boxes()
    Traceback (most recent call last):
    AssertionError: test_boxes is wrong on 53 of 100 pairs (53 %): 53 false positives.
      uniform                     53 of       100
    The smallest wrong pair that was found: it says intersects, but the triangles are disjoint.
      @graze.example('...')
    To see it: ...
    """
    kinds = (either,) if isinstance(either, str) else tuple(either)
    if unknown := set(kinds) - set(_EITHER):
        raise ValueError(f"either: {sorted(unknown)[0]!r} is none of {', '.join(_EITHER)}")
    numbers = _library.count_of(pairs, "pairs"), _library.count_of(seed, "seed")
    options = _library.Options(
        _library.name_of(strata, "strata"), *numbers, max_wrong, *(kind in kinds for kind in _EITHER)
    )

    def decorate(function: Callable[..., Any]) -> Callable[..., None]:
        examples: list[Pair] = list(getattr(function, "_graze_examples", ()))
        name = getattr(function, "__name__", "the function")

        def test(*self: Any) -> None:  # self: the object of a tested method
            __tracebackhide__ = True
            tested = _Tested(functools.partial(function, *self), name, vectorized)
            why = _check(tested, name, options, test._graze_examples)  # type: ignore[attr-defined]
            if why is not None:
                failure = AssertionError(why)
                failure.graze_says_all = tested.raised is None  # type: ignore[attr-defined]
                raise failure from tested.raised

        test.__name__, test.__doc__, test.__module__ = name, function.__doc__, function.__module__
        test.__qualname__ = getattr(function, "__qualname__", name)
        test._graze_examples = examples  # type: ignore[attr-defined]
        return test

    return decorate


def example(pair: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Adds a pair that a test made with `given` checks first: 18 numbers in a string or an array."""
    added = pair if isinstance(pair, Pair) else Pair(pair)

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        function._graze_examples = [added, *getattr(function, "_graze_examples", ())]  # type: ignore[attr-defined]
        return function

    return decorate
