"""A condensed contact on which nothing acts that may change."""

import numpy as np

from bemcontact.contact import CondensedContact


def at_rest(condensed: CondensedContact) -> CondensedContact:
    """Switch all load cases off, put all tools where they are not displaced, and unload them.

    Parameters
    ----------
    condensed : CondensedContact

    Returns
    -------
    CondensedContact
    """
    none = np.zeros((len(condensed.tools), 3))
    return condensed.with_factors({}).with_tools(none, none)
