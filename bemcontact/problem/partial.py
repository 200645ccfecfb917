"""A problem as it was written, of which one part can be read although another is wrong."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, Self, TypeVar

from pydantic import BaseModel, ValidationError

from bemcontact.errors import Path
from bemcontact.problem.validation import Stated, misspelled

Part = TypeVar("Part", bound=Stated)


class Written(NamedTuple):
    """A value in a problem and the path of keys to it, in the author's spelling."""

    path: Path
    value: Any

    def below(self, model: type[Stated], key: str) -> Self:
        """Go to what stands under a key of the model, misspelled or not; the value is None if there is nothing."""
        if isinstance(self.value, BaseModel):
            return self._replace(path=(*self.path, key), value=getattr(self.value, key, None))
        if not isinstance(self.value, Mapping):
            return self._replace(path=(*self.path, key), value=None)
        spelled = {meant: found for found, meant in misspelled(model, self.value).items()}.get(key, key)
        return self._replace(path=(*self.path, spelled), value=self.value.get(spelled))

    def each(self) -> Iterator[Self]:
        """Go through the entries of a list or of a mapping; anything else has none."""
        match self.value:
            case list() | tuple():
                entries = enumerate(self.value)
            case Mapping():
                entries = self.value.items()
            case _:
                return
        for key, value in entries:
            yield self._replace(path=(*self.path, key), value=value)

    def read(self, model: type[Part]) -> Part | None:
        """Make the part that the value states, if it is not made yet; None if it is wrong by itself."""
        if isinstance(self.value, model):
            return self.value
        try:
            return model.model_validate(self.value)
        except ValidationError:
            return None
