"""Error bars and accuracies made by hand."""

from bemcontact.assessment.accuracy import Accuracy, ErrorBar, Quantity


def bar(
    quantity: Quantity, value: float | None, error: float | None, zone: str | None = "foot", note: str = "", **more
):
    return ErrorBar(quantity=quantity, zone=zone, value=value, bar=error, note=note, **more)


def accuracy(*bars: ErrorBar, asked: float = 0.01, reason: str = "") -> dict:
    return Accuracy(**{**Accuracy.of(asked, 2, bars).__dict__, "reason": reason}).to_dict()
