"""Formulas as MathML, which browsers draw themselves: a page needs no script and no network for them."""

import re

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator


def visit(translator: HTML5Translator, node: nodes.math | nodes.math_block) -> None:
    """Write a formula; one that cannot be read is an error of the build."""
    if re.search(r"\\frac\s*\d", node.astext()):
        raise ValueError(
            f"{node.astext()}: write \\frac{{1}}{{2}}; docutils reads \\frac12 as twelve over what follows"
        )
    is_block = isinstance(node, nodes.math_block)
    tag = "div" if is_block else "span"
    formula = tex2mathml(node.astext(), as_block=is_block)
    translator.body.append(f"{translator.starttag(node, tag, CLASS='math')}{formula}</{tag}>")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Offer the renderer to ``html_math_renderer``."""
    app.add_html_math_renderer("mathml", (visit, None), (visit, None))
    return {"parallel_read_safe": True}
