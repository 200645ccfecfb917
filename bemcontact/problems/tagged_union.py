"""Unions of classes of which the key `kind` chooses one."""

from collections.abc import Mapping
from dataclasses import field
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from bemcontact.cached import cached_property
from bemcontact.errors import Issue
from bemcontact.frozen import frozen_value
from bemcontact.problems.validation import SpecModel, invalid, validation_error
from bemcontact.problems.wording import described, unknown_word


@frozen_value
class TaggedUnion:
    """Annotation of a union whose member is chosen by the key `kind`, here and in the JSON Schema.

    Parameters
    ----------
    what : name of the thing with its article, for error messages
    members : classes of the union; the default of the key `kind` of each is its kind
    default : kind of a mapping without the key `kind`; if None, the key is required
    other_kinds : words that are no kinds -> what to write instead
    own_keys : kinds that are told by a key of their name, so that `kind` may be left out
    """

    what: str
    members: tuple[type[SpecModel], ...]
    default: str | None = None
    other_kinds: Mapping[str, str] = field(default_factory=dict[str, str])
    own_keys: tuple[str, ...] = ()

    @property
    def example(self) -> str:
        """A value as YAML has it."""
        return self.members[0].example

    @cached_property
    def kinds(self) -> dict[str, type[SpecModel]]:
        """The members by their kind."""
        return {member.model_fields["kind"].default: member for member in self.members}

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Validate with the chosen member; the validators of the others are not even made."""
        return core_schema.no_info_plain_validator_function(self._chosen)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Choose by `kind` in the schema too, so that an editor checks the keys of the chosen kind."""
        for member in self.members:
            member.model_rebuild()
        union = core_schema.union_schema([member.__pydantic_core_schema__ for member in self.members])
        members = handler(union)["anyOf"]
        kinds = [handler.resolve_ref_schema(member)["properties"]["kind"]["const"] for member in members]
        chosen: JsonSchemaValue = {"type": "object", "properties": {"kind": {"enum": kinds}}}
        if self.default is None:
            chosen["required"] = ["kind"]
        return chosen | {"allOf": [self._choice(*pair) for pair in zip(kinds, members, strict=True)]}

    def _choice(self, kind: str, member: JsonSchemaValue) -> JsonSchemaValue:
        """Apply the schema of a member if its kind is given, or left out for the default."""
        condition: JsonSchemaValue = {"properties": {"kind": {"const": kind}}}
        if kind in self.own_keys:
            condition = {"anyOf": [{**condition, "required": ["kind"]}, {"required": [kind]}]}
        elif kind != self.default:
            condition["required"] = ["kind"]
        elif self.own_keys:
            condition["not"] = {"anyOf": [{"required": [key]} for key in self.own_keys]}
        return {"if": condition, "then": member}

    def _chosen(self, value: Any) -> SpecModel:
        """Validate a mapping as the kind that it names."""
        if isinstance(value, self.members):
            return value
        if not isinstance(value, Mapping):
            expected = f"expected a mapping that describes {self.what}, such as {self.example}"
            raise invalid(f"{expected}; found {described(value)}")
        told = next((key for key in self.own_keys if key in value), self.default)
        kind = value.get("kind", told)
        if not isinstance(kind, str) or kind not in self.kinds:
            raise validation_error(self.what, [Issue(path=("kind",), message=self._wrong_kind(value))])
        if "kind" not in value and (better := self._fitting(kind, value)):
            message = f"missing; {self.what} with these keys needs {' or '.join(f'kind: {word}' for word in better)}"
            raise validation_error(self.what, [Issue(path=("kind",), message=message)])
        return self.kinds[kind].model_validate(value)

    def _wrong_kind(self, value: Mapping[str, Any]) -> str:
        """Say that the kind is missing, not a text, or unknown."""
        if "kind" not in value:
            return f"missing; give the kind of {self.what}: {', '.join(self.kinds)}"
        if not isinstance(kind := value["kind"], str):
            return f"expected one of {', '.join(self.kinds)}; found {described(kind)}"
        if kind in self.other_kinds:
            return f"unknown kind '{kind}'; {self.other_kinds[kind]}"
        message = unknown_word("kind", kind, self.kinds)
        return message if "there are" in message else f"{message} There are: {', '.join(self.kinds)}"

    def _fitting(self, kind: str, value: Mapping[str, Any]) -> list[str]:
        """List the kinds that have all keys of a mapping, if the default kind does not."""
        if set(value) <= set(self.kinds[kind].model_fields):
            return []
        return [word for word, member in self.kinds.items() if set(value) <= set(member.model_fields)]
