"""A condensed contact on which nothing acts that may change."""

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
    return condensed.stepped(-condensed.cases.factors, -condensed.tools.position, -condensed.tools.force)
