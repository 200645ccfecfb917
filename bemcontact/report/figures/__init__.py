"""Pictures of a problem and of its result; the only room that knows matplotlib.

Each ``draw_...`` function draws into axes that it is given; each ``figure_of_...`` composes a page of them. Their names
and modules stand in ``__init__.pyi``. Each is imported when it is first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
