"""What all pages have in common: templates with their filters, numbers as pages write them, pictures in the page."""

import re
from base64 import b64encode
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from bemcontact.report.facts import NOTHING, percent, small
from bemcontact.report.formatting import number, plural, seconds_in_words, sentence_case, vector, with_unit

FORMULATIONS = {"qp1": "QP1", "qp2": "QP2", "qp3": "QP3"}
WIDE = 500.0
"""Points from which on a picture is wide."""


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A picture in the page."""

    source: str
    """The picture itself, as a data address."""
    alternative: str
    """What it shows, for those who do not see it."""
    caption: str
    """The line above it."""
    wide: bool
    """Whether it needs the whole width of the page."""


def template(name: str, **more: Callable[..., Any]) -> Template:
    """Return the template of a page, a file in ``templates``, with more filters; what it is given is text."""
    environment = Environment(
        loader=PackageLoader("bemcontact.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        number=_number, small=small, percent=percent, seconds=seconds_in_words, vector=vector, unit=with_unit,
        plural=plural, plain=_plain, capital=sentence_case, statement=statement, inertia=_inertia, **more,
    )  # fmt: skip
    return environment.get_template(name)


def picture(svg: bytes, caption: str, alternative: str) -> Picture:
    """Put an SVG into the page, with what it shows in words."""
    return Picture(
        source=f"data:image/svg+xml;base64,{b64encode(svg).decode('ascii')}",
        alternative=alternative,
        caption=caption,
        wide=_width(svg) > WIDE,
    )


def _number(value: float | None) -> str:
    """Five figures."""
    return NOTHING if value is None else number(value)


def _plain(text: str) -> str:
    """A name from a program, in words: local_minimum, element_length."""
    return text.replace("_", " ")


def statement(name: str) -> str:
    """The name of a formulation as it is printed."""
    return FORMULATIONS.get(name, name)


def _inertia(inertia: Sequence[int] | None) -> str:
    """How many eigenvalues are positive, zero and negative."""
    if inertia is None:
        return NOTHING
    return f"({', '.join(map(str, inertia))})"


def _width(svg: bytes) -> float:
    """Width in points that a picture states; 0 if it states none."""
    stated = re.search(rb'<svg[^>]* width="([\d.]+)pt"', svg)
    return float(stated[1]) if stated else 0.0
