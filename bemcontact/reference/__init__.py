"""Closed forms and published values, and the differences of an answer from them."""

from bemcontact.reference.evaluation import Expected, expected
from bemcontact.reference.scoring import Score, score

__all__ = ["Expected", "Score", "expected", "score"]
