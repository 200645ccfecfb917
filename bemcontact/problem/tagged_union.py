"""Parts of which there are several kinds: the key `kind` chooses the class that reads the mapping."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from bemcontact.errors import Complaint
from bemcontact.problem.validation import Stated, complain, described, listed, unknown_word, validation_error


@dataclass(frozen=True, kw_only=True)
class ByKind:
    """Annotation of a union: its member is chosen by the key `kind`, here and in the JSON Schema.

    Parameters
    ----------
    what : the thing in words, with its article
    kinds : the members of the union by their kind
    default : kind of a mapping that says none; without it, `kind` must be given
    """

    what: str
    kinds: Mapping[str, type[Stated]]
    default: str | None = None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Put the choice before the union, which only remains for the JSON Schema."""
        return core_schema.no_info_wrap_validator_function(lambda value, _: self._chosen(value), handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Choose as here does, so that an editor complains of the keys of the kind that is meant."""
        members = handler(schema)["anyOf"]
        kinds = [handler.resolve_ref_schema(member)["properties"]["kind"]["const"] for member in members]
        chosen: JsonSchemaValue = {"type": "object", "properties": {"kind": {"enum": kinds}}}
        if self.default is None:
            chosen["required"] = ["kind"]
        return chosen | {"allOf": [self._choice(*pair) for pair in zip(kinds, members, strict=True)]}

    def _choice(self, kind: str, member: JsonSchemaValue) -> JsonSchemaValue:
        """Apply the schema of a member where its kind is given, or left out if it is the default."""
        condition: JsonSchemaValue = {"properties": {"kind": {"const": kind}}}
        if kind != self.default:
            condition["required"] = ["kind"]
        return {"if": condition, "then": member}

    def _chosen(self, value: Any) -> Stated:
        """Read a mapping as the kind that it says it is."""
        if isinstance(value, tuple(self.kinds.values())):
            return value
        if not isinstance(value, Mapping):
            raise complain(f"expected a mapping that describes {self.what}, found {described(value)}")
        kind = value.get("kind", self.default)
        if not isinstance(kind, str) or kind not in self.kinds:
            raise validation_error(self.what, [Complaint(path=("kind",), message=self._no_kind(value))])
        if "kind" not in value and (better := self._fitting(kind, value)):
            message = f"missing; {self.what} with these keys needs {' or '.join(f'kind: {word}' for word in better)}"
            raise validation_error(self.what, [Complaint(path=("kind",), message=message)])
        return self.kinds[kind].model_validate(value)

    def _no_kind(self, value: Mapping[str, Any]) -> str:
        """Say that a kind is missing, no text, or none of those that there are."""
        if "kind" not in value:
            return f"missing; say which kind {self.what} is: {listed(self.kinds)}"
        if not isinstance(kind := value["kind"], str):
            return f"expected one of {listed(self.kinds)}; found {described(kind)}"
        return unknown_word("kind", kind, self.kinds)

    def _fitting(self, kind: str, value: Mapping[str, Any]) -> list[str]:
        """Find the kinds that know all keys of a mapping, if the default kind does not."""
        if set(value) <= set(self.kinds[kind].model_fields):
            return []
        return [word for word, member in self.kinds.items() if set(value) <= set(member.model_fields)]
