"""Problems from YAML, with line and column of each mistake; no other part of the package reads YAML."""

from bemcontact.spec.outline_file import outline
from bemcontact.spec.reading import as_run, load, loads, located, readable, schema, written_value
from bemcontact.spec.writing import dump, dumps

__all__ = ["as_run", "dump", "dumps", "load", "loads", "located", "outline", "readable", "schema", "written_value"]
