"""From YAML to a problem, with the line and column of every mistake; the only room that knows YAML."""

from bemcontact.spec.reading import as_run, load, loads, located, schema

__all__ = ["as_run", "load", "loads", "located", "schema"]
