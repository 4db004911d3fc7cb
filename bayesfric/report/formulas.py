"""Every symbol and equation of the report, in the notation of each form of it.

A formula is named by its TeX, which Markdown shows as it is; Typst and MathML beside it
are written here, so that no formula is ever parsed and none comes from a user.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Formula:
    """One formula in three notations.

    Parameters
    ----------
    typst : str
        In Typst's math mode.
    mathml : str
        The inside of a ``math`` element.
    spoken : str
        In words or plain characters, for people who do not see it.
    """

    typst: str
    mathml: str
    spoken: str


def _symbol(base: str, foot: str) -> Formula:
    """Return a letter, or letters multiplied, with one or more letters at its foot."""
    letters = _side_by_side(base)
    if not foot:
        return Formula(" ".join(base), letters, base)
    return Formula(
        f"{' '.join(base)}_({' '.join(foot)})",
        f"<msub>{letters}{_side_by_side(foot)}</msub>",
        f"{base}_{foot}",
    )


def _side_by_side(letters: str) -> str:
    marked = [f"<mn>{c}</mn>" if c.isdigit() else f"<mi>{c}</mi>" for c in letters]
    return marked[0] if len(marked) == 1 else f"<mrow>{''.join(marked)}</mrow>"


_LETTERS = ("T", "i", "j", "k", "n", "r", "v", "mg", "ζ", "θ", "κ", "λ", "τ", "ω", "ℓ")
_WITH_FOOT = (
    ("I", "0"), ("I", "ij"), ("T", "k"), ("c", "1"), ("c", "2"), ("c", "3"), ("f", "c"),
    ("f", "ij"), ("k", "t"), ("ε", "ij"), ("ζ", "ij"), ("η", "i"), ("θ", "k"), ("κ", "i"),
    ("ω", "2"), ("σ", "I"), ("σ", "a"),
    ("σ", "t"), ("σ", "x"), ("ΔT", "k"),
)  # fmt: skip

FORMULAS: dict[str, Formula] = {letter: _symbol(letter, "") for letter in _LETTERS} | {
    f"{base}_{foot if len(foot) == 1 else f'{{{foot}}}'}": _symbol(base, foot)
    for base, foot in _WITH_FOOT
}
"""By TeX."""

FORMULAS["σ_I^2"] = Formula(
    "σ_I^2", "<msubsup><mi>σ</mi><mi>I</mi><mn>2</mn></msubsup>", "sigma I squared"
)
_LOAD = r"\frac{r}{κ k_t}"
FORMULAS[_LOAD] = Formula(
    "r/(κ k_t)",
    "<mfrac><mi>r</mi><mrow><mi>κ</mi><msub><mi>k</mi><mi>t</mi></msub></mrow></mfrac>",
    "r over kappa k t",
)


def _equation(tex: str, spoken: str) -> str:
    """Add an equation, given as symbols and signs with blanks between, and return its name."""
    typst, mathml = [], []
    for sign in tex.replace(_LOAD, "LOAD").split():
        formula = FORMULAS.get(_LOAD if sign == "LOAD" else sign)
        number = sign.isdigit()
        # Browsers stretch brackets that need no stretching.
        plain = f"<mn>{sign}</mn>" if number else f'<mo stretchy="false">{sign}</mo>'
        typst.append(formula.typst if formula else sign)
        mathml.append(formula.mathml if formula else plain)
    FORMULAS[tex] = Formula(" ".join(typst), f"<mrow>{''.join(mathml)}</mrow>", spoken)
    return tex


LAW = _equation(
    "f_c = n ( ( c_1 + c_3 ( θ − 85 ) ) T + c_2 )",
    "f c equals n times, in brackets, c 1 plus c 3 times theta minus 85, times T, plus c 2.",
)
SCATTER = _equation(
    "f_{ij} = f_c ( 1 + η_i + ε_{ij} + ζ_{ij} ) + n c_2 κ_i",
    "f i j equals f c times, in brackets, one plus eta i plus epsilon i j plus zeta i j, end of "
    "brackets, plus n times c 2 times kappa i.",
)
RECURSIVE = _equation(
    "ΔT_k = ( c_1 + c_3 ( θ_k − 85 ) ) T_k + c_2",
    "delta T k equals, in brackets, c 1 plus c 3 times theta k minus 85, times T k, plus c 2.",
)
CURRENT = _equation(
    rf"I_{{ij}} = I_0 ( v ) + {_LOAD} ( mg + f_{{ij}} )",
    "I i j equals I zero of v plus r over kappa k t, times, in brackets, m g plus f i j.",
)
