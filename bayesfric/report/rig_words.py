"""What a rig and its law are called, as the rig itself says."""

from collections.abc import Sequence

from bayesfric.plots.rig_tables import RigTable
from bayesfric.report.quantities import format_count
from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import Words
from bayesfric.rigs.opening import DEFAULT


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


def counted(table: RigTable) -> str:
    """Return how many trials of a rig enter: 1 trial of the motor board."""
    trials = table.trial if table.count == 1 else table.trials
    return f"{format_count(table.count)} {trials} of the {table.title}"


def group_words(rigs: Sequence[str]) -> tuple[str, str]:
    """Return what trials of one setup are together, and several of these: of rigs that agree.

    Parameters
    ----------
    rigs : sequence of str
        As stored.
    """
    words_of_groups = {(words.group, words.groups) for words in map(rig_words, rigs)}
    return words_of_groups.pop() if len(words_of_groups) == 1 else (Words.group, Words.groups)


def law_words(law: str, rigs: Sequence[str]) -> str:
    """Return what a law is called: none is the paper's where no rig is one of its boards.

    Parameters
    ----------
    law : str
        As stored, a name in :data:`bayesfric.physics.laws.BASELINES`.
    rigs : sequence of str
        On which it was fitted.
    """
    rigs_by_name = all_rigs()
    if law != DEFAULT or any(
        name not in rigs_by_name or rigs_by_name[name].words.paper for name in rigs
    ):
        return law
    return f"{rig_words(rigs[0]).rig}'s own"
