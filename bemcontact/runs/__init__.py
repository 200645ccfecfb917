"""Runs that last: a study on several workers, with its journal and its folder."""
