"""Checks before any work: arguments of functions, and memory."""
