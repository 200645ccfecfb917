"""A spec as one of its variants: the values that the variant sets, in their places."""

from collections.abc import Iterator
from dataclasses import replace

from bemcontact.errors import ProblemError, SpecError
from bemcontact.problem import Problem, Variant
from bemcontact.problem.partial import Written
from bemcontact.problem.validation import unknown_word
from bemcontact.spec.document import Document, one_line_each


def varied(document: Document, name: str) -> Iterator[Document]:
    """Set the values of a variant one after the other, as `Problem.variant` does all at once.

    Parameters
    ----------
    document : a spec
    name : of the variant

    Yields
    ------
    Document
        After each value, whose place is that in the variant; none if the variant cannot be read, of which the problem
        of the spec itself will complain.

    Raises
    ------
    SpecError
        There is no such variant, or it sets what there is not.
    """
    stated = {str(item.path[-1]): item for item in Written((), document.data).below(Problem, "variants").each()}
    if name not in stated:
        raise SpecError(f"--variant {name or repr(name)}: {unknown_word('variant', name, stated)}")
    variant = stated[name].read(Variant)
    if variant is None:
        return
    path = stated[name].path
    data = {key: value for key, value in document.data.items() if key != "variants"}
    if isinstance(title := data.get("name"), str):
        data["name"] = f"{title}, {name}"
    try:
        paths = variant.paths(data)
    except ProblemError as error:
        found = [document.located(replace(item, path=(*path, *item.path))) for item in error.complaints]
        raise SpecError(one_line_each(found)) from None
    stage = replace(document, data=data)
    for key, target in paths.items():
        here = (*path, "set", key)
        stage = stage.changed(target, document.below(here), document.places[here].value)
        yield stage
