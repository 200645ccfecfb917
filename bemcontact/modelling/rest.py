"""A condensed contact on which nothing acts that may change."""

from bemcontact.contact.condensed_contact import CondensedContact


def at_rest(contact: CondensedContact) -> CondensedContact:
    """Switch all load cases off, put all tools where they are not displaced, and unload them.

    Parameters
    ----------
    contact : CondensedContact

    Returns
    -------
    CondensedContact
    """
    return contact.stepped(-contact.cases.factors, -contact.tools.position, -contact.tools.force)
