"""The facts of a message, whatever the words between them are."""

from collections.abc import Iterable

import pytest

import bemcontact


def assert_states(message: str, facts: str) -> None:
    """The facts stand in the message in this order; `…` between two facts is for any words; line breaks are blanks."""
    rest = " ".join(message.split())
    for fact in facts.split("…"):
        _, found, rest = rest.partition(fact.strip())
        assert found, f"{fact.strip()!r} is not where it should be in {message!r}"


def assert_each_states(messages: Iterable[str], facts: Iterable[str]) -> None:
    """As many messages as lines of facts, each with its own."""
    for message, own in zip(messages, facts, strict=True):
        assert_states(message, own)


def assert_one_mistake(text: str, start: str, facts: str) -> None:
    """A spec is refused by one line, which starts with a place and a key and states facts."""
    with pytest.raises(bemcontact.SpecError) as caught:
        bemcontact.loads(text, "body.yaml")
    [line] = str(caught.value).splitlines()
    assert line.startswith(f"body.yaml:{start}")
    assert_states(line, facts)
