"""Frictionless contact of elastic bodies and rigid surfaces: boundary elements, quadratic programs, a certificate.

>>> import bemcontact
>>> problem = bemcontact.load("models/cylinder_on_plane.yaml")  # doctest: +SKIP
>>> result = bemcontact.solve(problem)  # doctest: +SKIP
>>> result.certified, result.footprint.peak.pressure  # doctest: +SKIP

The public names and their modules stand in ``__init__.pyi``. Each is imported when it is first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
