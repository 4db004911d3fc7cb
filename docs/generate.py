"""Write what comes from the code: schemas, settings, loop files, effects, claims, verbs, notebooks.

Run ``python docs/generate.py`` after a change of one of these; a test compares the files
with what this would write.
"""

import json
import re
from pathlib import Path
from typing import Literal, get_args, get_origin

import typer
from pydantic import BaseModel

from bayesfric.analysis import Analysis, Prior, PriorOverrides
from bayesfric.claims import registered
from bayesfric.cli import app
from bayesfric.effects import all_effects
from bayesfric.inference.priors import describe
from bayesfric.invariants import statements
from bayesfric.margins import loop_cables, loop_file
from bayesfric.schemas import SCHEMAS

DOCS = Path(__file__).resolve().parent
NOTEBOOKS = {
    "statistician": "howto/statistician.md",
    "joint": "notebooks/joint.md",
    "margin": "notebooks/margin.md",
}
"""Notebooks and the pages that they are made of."""
FENCED = re.compile(r"^```(sh|python)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def pages() -> dict[str, str]:
    """Return file name, relative to this folder, to text."""
    schemas = {
        f"schemas/{name}.schema.json": json.dumps(model.model_json_schema(by_alias=True), indent=2)
        + "\n"
        for name, model in SCHEMAS.items()
    }
    notebooks = {
        f"notebooks/{name}.ipynb": _notebook(DOCS / page) for name, page in NOTEBOOKS.items()
    }
    return {
        **schemas,
        **notebooks,
        "analysis.md": _analysis(),
        "loop.md": _loop(),
        "effects.md": _effects(),
        "claims.md": _claims(),
        "results.md": _results(),
        "cli.md": _cli(),
    }


def _notebook(page: Path) -> str:
    """Return a page as a notebook: its blocks of Python and of the shell are cells to run."""
    words, *rest = FENCED.split(page.read_text(encoding="utf-8"))
    cells = [{"cell_type": "markdown"} | _cell(words, 0)]
    for language, code, words in zip(rest[::3], rest[1::3], rest[2::3], strict=True):
        shell = "%%sh\n" if language == "sh" else ""
        run = {"cell_type": "code", "execution_count": None, "outputs": []}
        cells.append(run | _cell(shell + code, len(cells)))
        if words.strip():
            cells.append({"cell_type": "markdown"} | _cell(words, len(cells)))
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook = {
        "cells": cells,
        "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"


def _cell(text: str, place: int) -> dict[str, object]:
    """Return what cells of either kind have; links to other pages lead nowhere from a notebook."""
    text = re.sub(r"\[([^]]+)\]\((?!https?:)[^)]*\)", r"\1", text)
    return {"id": f"cell-{place}", "metadata": {}, "source": text.strip().splitlines(keepends=True)}


def _results() -> str:
    lines = [
        "# What holds of every result",
        "",
        "Whatever the data were, a stored result obeys the rules below. What breaks one is a",
        "fault of the computation, and no finding: a diagnosis then says so in `checks` and",
        "`attention`, and its verdict is `undecided`. `bayesfric report` runs the rules of every",
        "file that it reads, and a test or a CI job of yours can run them on a file:",
        "",
        "```python",
        "from bayesfric.testing import check_result",
        "",
        'checks = check_result("bayesfric-run/diagnosis.json")',
        "assert all(check.holds for check in checks)",
        "```",
        "",
        "Each check has a `check` (its name), `holds`, and `detail`, which says what breaks it.",
    ]
    found = statements()
    common = set.intersection(*(set(rules) for rules in found.values()))
    lines += ["", "## Every file", ""]
    lines += [f"- `{name}`: {found['fit'][name]}" for name in found["fit"] if name in common]
    for kind, rules in found.items():
        lines += ["", f"## {kind}.json", ""]
        lines += [f"- `{name}`: {rule}" for name, rule in rules.items() if name not in common]
    return "\n".join(lines) + "\n"


def _analysis() -> str:
    lines = [
        "# analysis.toml",
        "",
        "Every choice of an analysis that is yours to make, given to a verb as",
        "`--config analysis.toml`. Each key has a default; a key that is not listed here",
        "is refused. A prior is written as a family with its numbers:",
        "",
        "```toml",
        "seed = 7",
        "",
        "[priors]",
        'c1 = { family = "half-normal", scale = 0.1 }',
        "",
        "[priors.pulleys.large]",
        'c2 = { family = "log-normal", median = 0.01, sd_log = 0.5 }',
        "",
        "[priors.effects.viscous]",
        'slope = { family = "half-normal", scale = 0.3 }',
        "",
        "[sampler]",
        "steps = 800",
        "```",
        "",
        "## Top level",
        "",
    ]
    sections = {
        name: field.annotation
        for name, field in Analysis.model_fields.items()
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel)
    }
    plain = {name for name in Analysis.model_fields if name not in sections}
    lines += _table(Analysis, plain)
    for name, model in sections.items():
        lines += ["", f"## [{name}]", "", _paragraph(model), "", *_table(model)]
    lines += ["", "## [priors.pulleys.SIZE]", "", _paragraph(PriorOverrides), ""]
    lines += _table(PriorOverrides)
    lines += ["", "## Families of priors", ""]
    for family in get_args(get_args(Prior)[0]):
        lines += [f"### {family.model_fields['family'].default}", "", _paragraph(family), ""]
        lines += [*_table(family, set(family.model_fields) - {"family"}), ""]
    return "\n".join(lines).rstrip() + "\n"


def _loop() -> str:
    lines = [
        "# LOOP.toml",
        "",
        "A cable-driven joint and its controller, given to `bayesfric margins`. Examples and a",
        "template with comments are in `data/loops/`. Units stand in the names of the keys; a key",
        "that is not listed here is refused. A number may be a distribution instead: one of the",
        "families half-normal, log-normal, normal and uniform of",
        "[analysis.md](analysis.md#families-of-priors):",
        "",
        "```toml",
        "[joint]",
        'kind = "revolute"',
        'inertia_kg_m2 = { family = "log-normal", median = 0.1, sd_log = 0.25 }',
        "```",
        "",
        "“At the motor” means at its shaft, before the gearbox. What no joint has is refused with "
        "the likely mistake: gearbox, capstan and transmission by which the joint's drum has a "
        "radius outside of 1 mm to 1 m, or a slide moves 10 times further than its cable or less "
        "far by as much (an inverted ratio?), a sample time or delay above 0.1 s, a drive that "
        "stretches its cable by more than 20 % at its current limit (mN·m/A or mA?), wrap angles "
        "below 3.2 (radians?), a cable or lever over 100 m, a phase margin above π (degrees?).",
        "",
        "## Top level",
        "",
        *_table(loop_file.Loop, {"name", "title", "assumptions", "extrapolate", "stiction_ratio"}),
    ]
    sections = {
        "[joint], revolute": loop_file.RevoluteJoint,
        "[joint], prismatic": loop_file.PrismaticJoint,
        "[drive]": loop_file.Drive,
        "[[runs]]": loop_cables.CableRun,
        "[cable]": loop_cables.Cable,
        "[second_stage]": loop_cables.SecondStage,
        "[coupling]": loop_cables.Coupling,
        "[[coupling.others]]": loop_cables.OtherJoint,
        "[controller]": loop_file.Controller,
        "[compensation]": loop_file.Compensation,
        "[kick]": loop_file.Kick,
        "[tool]": loop_file.Tool,
        "[spec]": loop_file.Spec,
    }
    for name, model in sections.items():
        lines += ["", f"## {name}", "", _paragraph(model), "", *_table(model)]
    return "\n".join(lines).rstrip() + "\n"


ACTS_ON = {
    "friction": "friction: a force against the motion, with the scatter of all friction",
    "drive": "the drive: a force against the motion that does not scatter",
    "reading": "the readings of events",
    "current": "the motor's current",
}


def _effects() -> str:
    lines = [
        "# Effects",
        "",
        "These are the effects that a diagnosis examines beside the friction law.",
        "`bayesfric simulate --effect NAME` adds one to a recording. Strength 1 changes",
        "friction, or its equivalent, by 10 % rms over the design. The variants of an effect",
        "are averaged with equal weight. A",
        "prior says what would be noticed; the plausible range says what would be believed.",
        "[How to write one](howto/effect.md).",
    ]
    for name, effect in sorted(all_effects(None).items()):
        lines += [
            "",
            f"## {name}",
            "",
            f"On a rig with it, {effect.sentence}.",
            "",
            f"- Acts on {ACTS_ON[effect.acts_on]}.",
            f"- Along: {', '.join(axis.replace('_', ' ') for axis in sorted(effect.axes))}.",
            f"- Variants: {', '.join(effect.laws)}.",
            *([f"- Needs of a rig: {', '.join(sorted(effect.needs))}."] if effect.needs else []),
            "",
            "| parameter | unit | meaning | prior | plausible | reference |",
            "|---|---|---|---|---|---|",
        ]
        lines += [
            f"| `{one.name}` | {one.unit} | {one.meaning} | {describe(one.prior)} "
            f"| {one.plausible[0]:g} to {one.plausible[1]:g} | {one.reference} |"
            for one in effect.parameters
        ]
    return "\n".join(lines) + "\n"


def _claims() -> str:
    lines = [
        "# Claims",
        "",
        "What `bayesfric claims` judges, each against the best of its rivals. A rival written",
        "`effect/variant` is the claimed law beside [that effect](effects.md); other rivals are",
        "laws of their own. The rules of a verdict stand in [`[claims]`](analysis.md#claims).",
    ]
    for claim in registered():
        lines += [
            "",
            f"## {claim.name}",
            "",
            f"{claim.statement} The paper: {claim.paper}",
            "",
            f"- Rivals: {', '.join(f'`{one.label}`' for one in claim.rivals) or 'none'}.",
        ]
        if claim.instead is not None:
            lines.append(
                "- Where no board with weights was recorded or asked for, it is judged on friction "
                "at constant speed: a motor board's, or that of points with all their columns."
            )
        if not claim.about_these_data:
            lines.append(
                "- Rests on the paper's numbers or on priors, and says nothing of a recording."
            )
    return "\n".join(lines) + "\n"


def _cli() -> str:
    lines = ["# Commands", "", "What `--help` prints of each."]
    group = typer.main.get_command(app)
    with group.make_context("bayesfric", [], resilient_parsing=True) as parent:
        for name in group.list_commands(parent):
            command = group.get_command(parent, name)
            context = type(parent)(command, parent=parent, info_name=name, terminal_width=96)
            lines += ["", f"## {name}", "", "```text", context.get_help().rstrip(), "```"]
    return "\n".join(line.rstrip() for line in "\n".join(lines).split("\n")) + "\n"


def _paragraph(model: type[BaseModel]) -> str:
    return "\n".join(line.strip() for line in (model.__doc__ or "").strip().splitlines())


def _table(model: type[BaseModel], names: set[str] | None = None) -> list[str]:
    lines = ["| key | default | meaning |", "|---|---|---|"]
    for name, field in model.model_fields.items():
        if names is None or name in names:
            default = "required" if field.is_required() else f"`{_default(field)}`"
            words = _choices(field.annotation)
            among = f" One of {', '.join(words)}." if len(words) > 1 else ""
            lines.append(f"| `{name}` | {default} | {field.description}{among} |")
    return lines


def _choices(annotation: object) -> list[str]:
    """Return the words that a key takes, where they are not any; as they are written."""
    if get_origin(annotation) is Literal:
        return [f"`{json.dumps(word)}`" for word in get_args(annotation)]
    return [word for inner in get_args(annotation) for word in _choices(inner)]


def _default(field: object) -> str:
    value = field.get_default(call_default_factory=True)  # type: ignore[attr-defined]
    if isinstance(value, BaseModel):
        inner = ", ".join(f"{key} = {json.dumps(part)}" for key, part in value.model_dump().items())
        return f"{{ {inner} }}"
    return "absent" if value is None else json.dumps(value)


if __name__ == "__main__":
    for name, text in pages().items():
        (DOCS / name).parent.mkdir(exist_ok=True)
        (DOCS / name).write_text(text, encoding="utf-8")
