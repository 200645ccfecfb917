"""From a problem to an assessed result: condense, solve, compare, follow, reproduce."""
