import hashlib
import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from bayesfric.plots.style import COLORS, TEXT_WIDTH, figure, size_styles, to_svg

DRAW = """
import hashlib
from bayesfric.plots.style import figure, to_svg
with figure(80, 50) as fig:
    axes = fig.subplots()
    axes.plot([0, 1, 2], [0, 1, -1], marker="o", label="$c_1$", clip_on=True)
    axes.scatter([0, 1], [1, 0], rasterized=True)
    axes.set_xlabel("Tension [N]")
    axes.legend()
svg = to_svg(fig)
"""


def test_two_processes_draw_the_same_bytes() -> None:
    code = DRAW + "print(hashlib.sha256(svg).hexdigest())"
    done = [
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        for _ in range(2)
    ]
    scope: dict[str, bytes] = {}
    exec(DRAW, scope)  # the same once more here, beside other tests
    assert {run.stdout.strip() for run in done} == {hashlib.sha256(scope["svg"]).hexdigest()}


def test_text_is_drawn_as_paths_without_a_date() -> None:
    with figure(80, 50) as fig:
        fig.subplots().set_title("Friction")
    svg = to_svg(fig)
    assert b"<text" not in svg
    assert b"dc:date" not in svg
    assert b'width="226.771654pt" height="141.732283pt"' in svg


def test_no_setting_outlives_the_figure_and_a_users_own_do_not_reach_it() -> None:
    own = {"font.size": 30.0, "lines.linestyle": ":", "svg.fonttype": "none"}
    with mpl.rc_context(own):
        before = dict(mpl.rcParams)
        with figure() as fig:
            (line,) = fig.subplots().plot([0, 1])
        svg = to_svg(fig)
        assert dict(mpl.rcParams) == before
    assert line.get_linestyle() == "-"
    assert fig.axes[0].xaxis.label.get_fontsize() == 8
    assert b"<text" not in svg
    assert fig.get_size_inches()[0] == pytest.approx(TEXT_WIDTH / 25.4)


def test_pyplot_keeps_no_state() -> None:
    code = "import sys, bayesfric.plots.style; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
    with figure() as fig:
        pass
    assert type(fig) is Figure


def test_the_three_sizes_differ_in_every_way() -> None:
    styles = size_styles(["small", "medium", "large"]).values()
    for part in ("color", "marker"):
        assert len({getattr(style, part) for style in styles}) == 3
    assert {style.color for style in styles} <= set(COLORS.values())


def test_own_names_get_styles_of_their_own_whatever_the_order() -> None:
    names = ["small", *(f"own-{i:02d}" for i in range(59))]
    styles = size_styles(names)
    assert list(styles) == names
    assert len({(s.color, s.marker) for s in styles.values()}) == 60
    assert size_styles(reversed(names)) == styles
    assert styles["small"] == size_styles(["small"])["small"]


@pytest.mark.parametrize("size", [(0, 50), (80, -1), (np.nan, 50)])
def test_a_figure_without_area_is_refused(size: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="width and height in mm"), figure(*size):
        pass


def test_the_text_width_is_that_of_the_page() -> None:
    template = Path(sys.modules["bayesfric.plots.style"].__file__ or "").parents[1]
    typ = (template / "report" / "template.typ").read_text(encoding="utf-8")
    assert f"#let text-width = {TEXT_WIDTH:.0f}mm" in typ
