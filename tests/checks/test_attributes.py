"""Attributes that do not exist: each known word leads to a place that is there, and objects behave as before."""

import copy
import pickle
import re
import warnings
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tool_problems import FREE, FREE_CASES, made

import bemcontact
from bemcontact.checks.attributes import OF_A_RESULT, PLACES, WithHints

GALLERY = Path(__file__).parents[2] / "models" / "gallery"
WORDS = [word for words in PLACES.values() for word in words]


@cache
def objects() -> dict[str, Any]:
    result = bemcontact.solve(bemcontact.load(GALLERY / "hertz_small.yaml").with_value("accuracy", 0.1))
    model = bemcontact.model(result.contact)
    cases = bemcontact.solve_cases(made(FREE, **FREE_CASES))
    parts = {"contact": result.contact, "solution": result.solution, "footprint": result.footprint}
    where, accuracy = result.footprint, result.accuracy
    small = {"peak": where.peak, "interval": where.intervals[0], "resultant": where.resultant}
    small |= {"accuracy": accuracy, "bar": accuracy.bars[0], "boundary": result.boundary}
    return {"result": result, **parts, **small, "model": model, "of a model": model.solve(), "cases": cases}


SMALL = ("peak", "interval", "resultant", "accuracy", "bar", "boundary")
NAMES = ("result", "contact", "solution", "footprint", *SMALL, "model", "of a model", "cases")


def hints(name: str) -> Iterator[tuple[str, str]]:
    """Each word that an object does not have, and the sentence that it gets."""
    own = objects()[name]._called
    for word in (*WORDS, *(word for words in own.values() for word in words)):
        if not hasattr(objects()[name], word):
            with pytest.raises(AttributeError) as error:
                getattr(objects()[name], word)
            yield word, str(error.value)


@pytest.mark.parametrize("name", NAMES)
def test_each_place_that_is_named_is_there(name: str):
    owner = objects()[name]
    for word, text in hints(name):
        assert text.startswith(f"{type(owner).__name__} has no '{word}'; ")
        _, use, place = text.partition("; use ")
        if use:
            for one in re.split(" and ", place.partition(",")[0]):
                eval(f"owner.{one}", {"owner": owner})
        else:
            assert f"; {OF_A_RESULT} " in text or "; there are: " in text


def test_no_part_is_sent_back_to_itself():
    """What an error bar, a peak or an interval has of its own is named, not the place of all of them."""
    result = objects()["result"]
    homes = {"peak": "footprint.peak", "bar": "accuracy.bars", "interval": "footprint.intervals"}
    homes |= {"accuracy": "accuracy", "resultant": "footprint.resultant", "boundary": "boundary"}
    assert {name for name in NAMES if objects()[name]._called} == {*SMALL}
    for name, home in homes.items():
        assert all(not f"{text} ".endswith(f"{OF_A_RESULT} {home} ") for _, text in hints(name)), name
        assert eval(f"result.{home}", {"result": result}) is not None


def test_a_result_has_all_of_them():
    assert all("; use " in text for _, text in hints("result"))
    for place in PLACES:
        eval(f"owner.{place}", {"owner": objects()["result"]})


@pytest.mark.parametrize(
    ("name", "wrong", "place"),
    [
        ("result", "max_pressure", "footprint.peak.pressure"),
        ("result", "resultant", "footprint.resultant.force"),
        ("result", "force", "footprint.resultant.force"),
        ("result", "stresses", "stress"),
        ("result", "von_mises", "largest_stresses"),
        ("result", "max_stress", "largest_stresses"),
        ("contact", "stiffness", "stiffness_rows"),
        ("contact", "max_pressure", "peak"),
        ("model", "force", "resultant"),
        ("peak", "point", "at"),
        ("bar", "error", "bar, which is relative"),
        ("interval", "ends", "start and end"),
        ("interval", "width", "length"),
        ("accuracy", "peak", 'bar_of, such as bar_of("peak", "foot")'),
        ("boundary", "nodes", "points"),
    ],
)
def test_words_of_users_lead_to_the_quantity(name: str, wrong: str, place: str):
    with pytest.raises(AttributeError, match=rf"; use {re.escape(place)}$"):
        getattr(objects()[name], wrong)


@pytest.mark.parametrize("name", NAMES)
def test_misspelled_names_get_the_right_one(name: str):
    for right in [part for part in dir(objects()[name]) if len(part) > 6 and not part.startswith("_")]:
        with pytest.raises(AttributeError, match=f"did you mean '{right}'"):
            getattr(objects()[name], right[:4] + right[5:])


@pytest.mark.parametrize("name", NAMES)
def test_objects_behave_as_before(name: str):
    """Defaults, copies, pickles, NumPy, completion; nothing warns, and no name is added."""
    owner = objects()[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert getattr(owner, "nothing_of_the_kind", 7) == 7
        assert not hasattr(owner, "_repr_mimebundle_")
        assert not hasattr(owner, "__array__")
        assert np.asarray(owner, object).shape == ()
        copied = copy.copy(owner)
        assert {*vars(owner)} - {*vars(copied)} <= {*dir(type(owner))}  # what is computed once may be computed anew
        if name not in ("model", "of a model"):  # an expression of cvxpy has an identity
            again = pickle.loads(pickle.dumps(owner))
            assert type(again) is type(owner)
            assert type(copy.deepcopy(owner)) is type(owner)
        assert {*dir(owner)} == {*object.__dir__(owner)}


def test_an_error_within_a_property_is_its_own():
    class Broken(WithHints):
        @property
        def pressure(self) -> float:
            return self.inner.value  # pyright: ignore

        @property
        def other(self) -> float:
            return [].value  # pyright: ignore

    with pytest.raises(AttributeError, match="'list' object has no attribute 'value'"):
        _ = Broken().other
    with pytest.raises(AttributeError, match="Broken has no 'inner'"):
        _ = Broken().pressure


def test_names_that_are_not_there_are_answered_with_those_that_are():
    result = objects()["result"]
    for values, name, there in (
        (result.boundary_stress(), "web right", "there is no edge 'web right'; there are: rim, top, axis"),
        (result.forces, "foots", "there is no contact 'foots'; there are: foot"),
    ):
        with pytest.raises(bemcontact.ProblemError, match=re.escape(there)):
            values[name]
        assert values.get(name) is None
        assert name not in values
        assert copy.deepcopy(values).keys() == pickle.loads(pickle.dumps(values)).keys() == values.keys()
