"""A document with everything in it."""

from datetime import UTC, datetime

from bayesfric.report.content import (
    Block,
    BulletList,
    Code,
    Column,
    Document,
    Emphasis,
    Equation,
    Figure,
    Heading,
    Listing,
    Math,
    Notice,
    Paragraph,
    Reference,
    Strong,
    Table,
)
from bayesfric.report.formulas import LAW

SVG = (
    b'<svg xmlns="http://www.w3.org/2000/svg" width="100" height="50" viewBox="0 0 100 50">'
    b'<rect id="same" width="100" height="50" fill="#0072b2"/></svg>'
)


def document(**changes: object) -> Document:
    blocks: list[Block] = [
        Notice("attention", ["See ", Reference("law"), "."], title="Unconverged"),
        Notice("good", "All is well."),
        Notice("info", "Synthetic data."),
        Heading(1, "First chapter", label="first"),
        Paragraph(
            ["Plain, ", Emphasis("slanted"), ", ", Strong("bold"), ", ", Code("a.toml"), "."]
        ),
        Paragraph(["The paper has ", Math("c_1"), "."]),
        Equation(LAW, label="law"),
        Heading(2, "Numbers"),
        Table(
            "Coefficients.",
            ["Pulley", Column(Math("c_1"), "N", "decimal"), Column("Informed", align="center")],
            [["small", "0.0128", "yes"], ["large", "12.5", "no"], ["mine", "—", "no"]],
            label="coefficients",
            note="A dash: not informed.",
        ),
        Figure(
            lambda: SVG, "A blue field.", "A rectangle filled with blue.", label="field", width=0.5
        ),
        Figure(lambda: SVG, "The same field.", "The same rectangle.", label="again"),
        Heading(3, "Details"),
        BulletList(["one", ["two: ", Reference("coefficients")], [Reference("again")]]),
        Listing("bayesfric run\n  --seed 1"),
        Heading(1, "Second chapter"),
        Paragraph(["Back to ", Reference("first"), "."]),
    ]
    fields: dict[str, object] = {
        "title": "A sample report",
        "subtitle": "With everything in it",
        "blocks": blocks,
        "date": datetime(2026, 3, 4, 5, 6, 7, tzinfo=UTC),
    }
    return Document(**(fields | changes))  # type: ignore[arg-type]
