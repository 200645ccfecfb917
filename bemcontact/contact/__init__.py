"""The waist: a condensed contact problem, its load cases and tools, its scales and gauge, and a solution of it."""
