"""From a problem to a judged answer: condense, solve, compare, follow, reproduce."""
