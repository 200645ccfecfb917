"""Meshes that fit the answer."""
