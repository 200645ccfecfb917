"""The answer beside what is known of it: closed forms and published values, evaluated, and how far they are off."""

from bemcontact.reference.evaluation import expected
from bemcontact.reference.expectation import Expected
from bemcontact.reference.scoring import Score, score

__all__ = ["Expected", "Score", "expected", "score"]
