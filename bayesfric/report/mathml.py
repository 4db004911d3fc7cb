"""Formulas as MathML, which browsers show and screen readers speak."""

from markupsafe import Markup

from bayesfric.report import formula
from bayesfric.report.characters import legible

__all__ = ["to_mathml"]

_SPACING_ACCENTS = {"\u0304": "¯", "\u0302": "^", "\u0307": "˙", "\u0308": "¨", "\u0303": "~"}
_OPERATORS = frozenset("=≤≥≠≈∼→∈∝<>+−±·×∗∣/,;:.!|∑∫∂")


def to_mathml(source: str, alt: str, block: bool = False) -> Markup:
    """Write a formula as a ``math`` element.

    Parameters
    ----------
    source : str
        As in `bayesfric.report.formula`.
    alt : str
        What is read aloud where MathML is not understood.
    block : bool
        Whether it stands on a line of its own.
    """
    display = Markup(' display="block"') if block else ""
    return Markup('<math alttext="{}"{}>{}</math>').format(
        legible(alt), display, _element(formula.parse(source))
    )


def _element(tree: formula.Formula) -> Markup:
    match tree:
        case formula.Symbol(character):
            return _tag("mo" if character in _OPERATORS else "mi", legible(character))
        case formula.Number(digits):
            return _tag("mn", digits)
        case formula.Words(text):
            # Blanks at the ends of mtext would be dropped.
            return _tag("mtext", legible(text).replace(" ", "\u00a0"))
        case formula.Function(name):
            return _tag("mi", name)
        case formula.Row(items):
            return _tag("mrow", *map(_element, items))
        case formula.Bracket(left, body, right):
            tall = _is_tall(body)
            return _tag("mrow", _fence(left, tall), _element(body), _fence(right, tall))
        case formula.Fraction(above, below):
            return _tag("mfrac", _element(above), _element(below))
        case formula.Root(body):
            return _tag("msqrt", _element(body))
        case formula.Accent(body, mark):
            over = _tag("mo", _SPACING_ACCENTS[mark])
            return Markup('<mover accent="true">{}{}</mover>').format(_element(body), over)
        case formula.Scripts(base, None, sup) if sup is not None:
            return _tag("msup", _element(base), _element(sup))
        case formula.Scripts(base, sub, None) if sub is not None:
            return _tag("msub", _element(base), _element(sub))
        case formula.Scripts(base, sub, sup) if sub is not None and sup is not None:
            return _tag("msubsup", _element(base), _element(sub), _element(sup))
        case _:
            raise TypeError(f"not a formula: {tree!r}")


def _tag(name: str, *parts: str) -> Markup:
    # `format` escapes a plain str and keeps Markup as it is.
    body = Markup("").join(parts)
    return Markup(f"<{name}>{{}}</{name}>").format(body)


def _fence(character: str, tall: bool) -> Markup:
    # Without a font for mathematics, browsers stretch brackets that need no stretching.
    return Markup('<mo stretchy="{}">{}</mo>').format("true" if tall else "false", character)


def _is_tall(tree: formula.Formula) -> bool:
    match tree:
        case formula.Fraction() | formula.Root():
            return True
        case formula.Row(items):
            return any(_is_tall(item) for item in items)
        case formula.Bracket(_, body, _) | formula.Accent(body, _):
            return _is_tall(body)
        case formula.Scripts(base, _, _):
            return _is_tall(base)
        case _:
            return False
