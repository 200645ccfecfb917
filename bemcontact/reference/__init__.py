"""The answer beside what is known of it: closed forms and published values, evaluated, and how far they are off."""

from bemcontact.reference.evaluation import Expected, expected
from bemcontact.reference.scoring import Score, score

__all__ = ["Expected", "Score", "expected", "score"]
