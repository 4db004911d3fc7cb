"""Draw mutants of some modules: ``python mutants.py SEED SIZE MODULE...`` prints them as JSON.

This runs in the environment of ``tools.txt``, and not in the project's. Of all mutants in
the order of their modules, each module's own shuffled, every k-th is taken: a sample in which a
module has its share. Left out are mutants that no test could miss, as ``+`` turned into ``<<``
is, or that only change how code is written: they would flatter the figure.
"""

import difflib
import json
import re
import sys
from pathlib import Path
from random import Random

from cosmic_ray import plugins
from cosmic_ray.ast import ast_nodes, get_ast_from_path
from cosmic_ray.mutating import mutate_code

ARITHMETIC = "(Add|Sub|Mul|Div|Pow)"
KEPT = re.compile(
    rf"core/(ReplaceBinaryOperator_({ARITHMETIC}_{ARITHMETIC}|BitOr_BitAnd|BitAnd_BitOr)"
    r"|ReplaceComparisonOperator_((Eq|NotEq|[LG]tE?)_(Eq|NotEq|[LG]tE?)|Is_IsNot|IsNot_Is)"
    r"|ReplaceUnaryOperator_Delete_\w+|Replace(True|False|And|Or|Break|Continue)With\w+"
    r"|AddNot|NumberReplacer|ZeroIterationForLoop)"
)


def places(module: str) -> list[tuple[str, str, int]]:
    """Return module, operator and occurrence of each mutant of a module."""
    tree = get_ast_from_path(Path(module))
    every_place = []
    for name in filter(KEPT.fullmatch, sorted(plugins.operator_names())):
        operator = plugins.get_operator(name)()
        count = sum(len(list(operator.mutation_positions(node))) for node in ast_nodes(tree))
        every_place += [(module, name, at) for at in range(count)]
    return every_place


def mutant(module: str, name: str, at: int) -> dict:
    """Return a mutant: what was changed where, and the module as it is then."""
    before = Path(module).read_text(encoding="utf-8")
    after = mutate_code(before, plugins.get_operator(name)(), at)
    old, new = before.splitlines(), after.splitlines()
    diff = list(difflib.unified_diff(old, new, n=0, lineterm=""))[2:]
    line = next(n for n, (a, b) in enumerate(zip(old, new, strict=False), 1) if a != b)
    key = f"{module}:{name.removeprefix('core/')}:{at}"
    return {"mutant": key, "module": module, "line": line, "diff": diff[1:], "source": after}


if __name__ == "__main__":
    random, size = Random(int(sys.argv[1])), int(sys.argv[2])
    every: list[tuple[str, str, int]] = []
    for module in sys.argv[3:]:
        own = places(module)
        every += random.sample(own, len(own))
    step = len(every) / size
    start = random.random() * step
    drawn = [every[int(start + i * step)] for i in range(size)]
    random.shuffle(drawn)
    json.dump({"of": len(every), "drawn": [mutant(*place) for place in drawn]}, sys.stdout)
