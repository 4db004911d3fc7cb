"""Write what comes from the code: schemas, settings, loop files, effects, claims, verbs, notebooks.

Run ``python docs/generate.py`` after a change of one of these; a test compares the files
with what this would write.
"""

import json
import re
from collections.abc import Iterable
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
        "# Rules that every result obeys",
        "",
        "A stored result obeys the rules below for any data. If a result breaks a rule, the",
        "computation is wrong. `diagnosis.json` then lists the broken rule in `checks` and",
        "`attention`, and the verdict is `undecided`. `bayesfric report` checks every file that",
        "it reads. Your own test or CI job can check a file, too:",
        "",
        "```python",
        "from bayesfric.testing import check_result",
        "",
        'checks = check_result("bayesfric-run/diagnosis.json")',
        "assert all(check.holds for check in checks)",
        "```",
        "",
        "Each check has a name (`check`), whether it `holds`, and a `detail` that describes "
        "the violation.",
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
        "This file holds your choices for an analysis. Give it to a command as",
        "`--config analysis.toml`. Each key has a default. An unknown key is refused.",
        "A prior is a family with its numbers:",
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
        "This file describes a cable-driven joint and its controller for `bayesfric margins`.",
        "Examples and a template with comments are in `data/loops/`. The names of the keys have "
        "the",
        "units. An unknown key is refused. A number may also be a distribution: half-normal,",
        "log-normal, normal or uniform, as in [analysis.md](analysis.md#families-of-priors):",
        "",
        "```toml",
        "[joint]",
        'kind = "revolute"',
        'inertia_kg_m2 = { family = "log-normal", median = 0.1, sd_log = 0.25 }',
        "```",
        "",
        "“At the motor” means at its shaft, before the gearbox.",
        "",
        "Impossible numbers are refused, with the likely mistake in the message:",
        "",
        "- a drum of the joint with a radius outside of 1 mm to 1 m, or a slide that moves 10 "
        "times "
        "more or less than its cable (an inverted ratio?);",
        "- a sample time or delay above 0.1 s;",
        "- a drive that stretches its cable by more than 20 % at its current limit (mN·m/A or "
        "mA?);",
        "- wrap angles below 3.2 (radians?);",
        "- a cable or lever over 100 m;",
        "- a phase margin above π (degrees?).",
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
    "friction": (
        "friction: a force against the motion. It varies between assemblies and trials in the same "
        "proportion as the rest of friction"
    ),
    "drive": "the drive: a force against the motion that is the same in all assemblies and trials",
    "reading": "the readings of events",
    "current": "the motor's current",
}

NEEDED = {
    "acting-gravity": "gravity that acts on the load (`rig.gravity_m_s2` above 0)",
    "angle": "an axis that turns",
    "commanded-force": "a commanded force, not a measured one (`rig.force_is`)",
    "direction": "motion in both directions",
    "drive": "the drive force at each sample of a run",
    "dwell": "rests of different lengths before the motion starts",
    "known-load": "a load of known mass or torque",
    "law-without-coulomb": "a friction law without a Coulomb term",
    "law-without-offset": "a friction law without a constant offset",
    "limit": "a drive with a force limit, which must be above friction",
    "load-both-ways": "a load that is lifted and lowered at the same pose, or two different loads",
    "period": "the position at each sample of a run",
    "play": "at least 6 reversals",
    "position": "the position at each sample of a run",
    "pulleys": "a rig with pulleys",
    "spring": "at least 6 reversals",
    "test": "runs whose `role` is `test`",
    "turns": "at least 4 reversals",
    "warmth": (
        "either a driven axis with a logged temperature that varies, or whose work done by "
        "friction does not only grow with the order of the runs; or friction points without "
        "pulleys and without a temperature column, of which the diagnosis uses the order"
    ),
}
"""What an effect needs (`Effect.needs`), in words."""

BEHIND = "The variants differ in the share of the mass that is behind the {part} (see `share`)"
GEAR_LOAD = (
    "In `of-what-is-held` the load of the gear is only that of gravity and springs; in the other "
    "{count}, it includes the force that accelerates the mass"
)
VARIANTS = {
    "backlash": f"{BEHIND.format(part='backlash')}; in `friction` no mass is behind it",
    "load-friction": GEAR_LOAD.format(count="variant"),
    "load-quadratic": GEAR_LOAD.format(count="variant"),
    "load-stribeck": (
        f"{GEAR_LOAD.format(count='variants')}. In `half-stays` friction falls to half at high "
        "speed, in the others to zero"
    ),
    "transmission-compliance": (
        f"{BEHIND.format(part='spring')}; in `rings-mass-alone` only mass is behind it. In the "
        "variants with `rings` the load is simulated as a mass on a spring, which may oscillate; "
        "the others are formulas for a load that follows without oscillation. In `seen-at-load` "
        "the position is measured behind the spring, and elsewhere at the motor"
    ),
}
"""What the variants of an effect are (`Effect.laws`), if their names do not say it."""


def _needed(needs: frozenset[str]) -> list[str]:
    if not needs:
        return []
    words = dict.fromkeys(NEEDED.get(need, f"the column `{need}`") for need in sorted(needs))
    return [f"- The diagnosis examines this effect only with: {'; '.join(words)}."]


def _variants(name: str, laws: Iterable[str]) -> str:
    words = f" {VARIANTS[name]}." if name in VARIANTS else ""
    return f"- Variants: {', '.join(laws)}.{words}"


def _effects() -> str:
    lines = [
        "# Effects",
        "",
        "A diagnosis examines these effects. The friction law does not contain them.",
        "`bayesfric simulate --effect NAME` simulates a recording with an effect, at strength 1.",
        "Strength 1 changes friction by 10 % rms, or changes a force, a reading or a current by",
        "the equivalent of 10 % of friction ([definition](decisions/strength.md)).",
        "",
        "An effect may have several variants: functional forms to which the diagnosis gives",
        "equal weight. `Varies with` lists the variables with which the effect changes the force",
        "or the reading in a way that the refitted friction law cannot absorb.",
        "The prior of a parameter covers the sizes that the diagnosis looks for. Its plausible",
        "range contains the sizes that are physically credible.",
        "",
        "[You can write your own effect](howto/effect.md).",
    ]
    for name, effect in sorted(all_effects(None).items()):
        lines += [
            "",
            f"## {name}",
            "",
            f"{effect.sentence[:1].upper()}{effect.sentence[1:]}.",
            "",
            f"- Acts on {ACTS_ON[effect.acts_on]}.",
            f"- Varies with: {', '.join(axis.replace('_', ' ') for axis in sorted(effect.axes))}.",
            _variants(name, effect.laws),
            *_needed(effect.needs),
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
        "`bayesfric claims` judges these claims. It compares each with the best of its rivals. "
        "A rival",
        "`effect/variant` is the claimed law with [that effect](effects.md); other rivals are",
        "different laws. [`[claims]`](analysis.md#claims) has the rules of a verdict.",
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
                "- If the recording has no gravity board, the claim is judged on friction at "
                "constant speed: on the data of a motor board, or on friction points if their "
                "table has all columns that the claim uses."
            )
        if not claim.about_these_data:
            lines.append("- It depends on the paper's numbers or on priors, not on a recording.")
    return "\n".join(lines) + "\n"


def _cli() -> str:
    lines = ["# Commands", "", "The `--help` text of each command."]
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
