"""JSON Schema in which the docstring below a field is its description.

Pydantic can look for these docstrings itself, whenever a class is made. That takes longer than all else that it does.
"""

from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from bemcontact.checks.docstrings import attribute_docstrings


class DescribedSchema(GenerateJsonSchema):
    """Makes the schemas of models."""

    def model_schema(self, schema: Any) -> dict[str, Any]:
        """Describe a model and its fields."""
        return with_descriptions(super().model_schema(schema), schema["cls"])


def with_descriptions(stated: dict[str, Any], kind: type) -> dict[str, Any]:
    """The schema of a class with descriptions of its fields."""
    properties = stated.get("properties", {})
    for name, text in attribute_docstrings(kind).items():
        if name in properties:
            properties[name].setdefault("description", text)
    return stated
