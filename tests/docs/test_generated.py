"""The parts of the reference that are made from the program: nothing is left out of them."""

import re
from typing import Any

import generated
import pages
import pytest
import typer.main

import bemcontact
from bemcontact import cli


def keys(schema: dict[str, Any]) -> set[str]:
    """All keys of a schema: those of its own, and those of what it defines."""
    objects = [schema, *schema["$defs"].values()]
    return {key for part in objects for key in part.get("properties", {})}


def shown(text: str) -> set[str]:
    return set(re.findall(r"^\[`([^`]*)`\]\{#", text, flags=re.MULTILINE))


def test_each_key_of_a_problem_file_is_shown():
    assert shown(generated.spec()) == keys(bemcontact.schema())


def test_no_place_of_an_object_is_listed_twice():
    """Edges of each kind have a grading, all at one place."""
    places = re.findall(r"^Stands at (.*)\.$", generated.spec(), flags=re.MULTILINE)
    assert "`boundary.outer[].grading`" in places
    assert all(len(each.split(", ")) == len({*each.split(", ")}) for each in places)


def test_each_key_of_each_json_file_is_shown():
    """The command schema has an option for each file of results."""
    text = generated.json_files()
    options = [parameter.opts[0] for parameter in generated.COMMANDS.commands["schema"].params]
    assert {"--result", "--cases", "--path", "--report", "--reproduction"} <= {*options}
    for option in options:
        part = text.partition(f"\n## `schema {option}`\n")[2].partition("\n## ")[0]
        assert keys(generated._schema(option)) == shown(part), option


def test_each_option_of_each_command_is_shown():
    text = generated.commands()
    for name, command in typer.main.get_command(cli.app).commands.items():
        part = text.partition(f"\n## {name}\n")[2].partition("\n## ")[0]
        options = {option for parameter in command.params for option in parameter.opts if option.startswith("--")}
        assert options == {key.split()[0] for key in shown(part) if key.startswith("--")}


def test_each_public_name_has_a_place():
    page = (pages.DOCS / "reference" / "python.md").read_text(encoding="utf-8")
    names = " ".join(words for what, words in generated.MARK.findall(page) if what == "names").split()
    assert sorted(names) == sorted(generated.public())
    assert {"load", "solve", "Result", "SpecError"} <= {*names}


@pytest.mark.slow
def test_what_functions_and_methods_give_is_documented():
    """`solve_lcp` is a function, `ContactModel.solve` a method; JSON forms have pages of their own."""
    documented = re.findall(r"autoclass:: bemcontact\.\S*?(\w+)$", generated.parts(), flags=re.MULTILINE)
    assert {"LcpResult", "ModelResult", "Footprint", "Accuracy"} <= {*documented}
    assert not {"ResultRecord", "CasesRecord", "Problem"} & {*documented}


def test_a_part_that_does_not_exist_is_an_error():
    with pytest.raises(KeyError, match="nothing"):
        generated.fill(None, "page", ["<!-- generated: nothing -->"])  # pyright: ignore[reportArgumentType]


def test_values_are_described_in_words():
    schema = {"$defs": {"FlatPunch": {"properties": {}}, "Name": {"enum": ["a", "b"], "type": "string"}}}
    described = {
        "[Flat punch](#yaml-flatpunch)": {"$ref": "#/$defs/FlatPunch"},
        "`a` or `b`": {"$ref": "#/$defs/Name"},
        "integer ≥ 1 and ≤ 9": {"type": "integer", "minimum": 1, "maximum": 9},
        "list of 2 numbers > 0": {
            "type": "array",
            "items": {"type": "number", "exclusiveMinimum": 0},
            "minItems": 2,
            "maxItems": 2,
        },
        "[number, text]": {"type": "array", "prefixItems": [{"type": "number"}, {"type": "string"}]},
        "mapping of names to true or false": {"type": "object", "additionalProperties": {"type": "boolean"}},
        "text": {"anyOf": [{"type": "string"}, {"type": "null"}]},
    }
    assert {generated._value(node, schema, "yaml"): node for node in described.values()} == described
    assert generated._value({"anyOf": [{"type": "string"}, {"type": "null"}]}, schema, "json") == "text or null"
