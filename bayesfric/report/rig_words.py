"""What a rig is called, as the rig itself says."""

from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import Words

__all__ = ["rig_words"]


def rig_words(name: str) -> Words:
    """Return the words of a rig.

    Parameters
    ----------
    name : str
        As stored. Results may come from an installation with rigs that this one lacks:
        of these nothing but the name is known.
    """
    rig = all_rigs().get(name)
    return rig.words if rig is not None else Words(f"rig {name}", "trial", "trials")
