"""A hundred strings that one notation or another would act on, as names that a user may choose."""

MARKUP = (
    "#panic()", "$x$", "*star*", "_under_", "<label>", "@reference", "back\\slash",
    "\"double\" and 'single'", "`tick`", "[a](b)", "{{ jinja }} {% raw %}",
    "// no comment -- here", "a | b", "&amp; <b>bold</b>", "<script>alert(1)</script>",
    "= heading", "1. first", "- dash", "~tilde~", "é ñ ß ø Ω",
)  # fmt: skip
TYPST = (
    '#read("/etc/passwd")', "#import \"x.typ\"", "#{ let x = 1 }", "#let x = 1", "#set page(1pt)",
    "#show: none", "$ sum_x $", "/* no comment */", "\\u{202e}", "#pagebreak()", "#eval(\"1\")",
    "== Two", "+ numbered", "/ Term: is", "```raw```", "#link(\"a\")[b]", "<a>@a", "~~~",
)  # fmt: skip
HTML = (
    "<img src=x onerror=alert(1)>", "</td></tr></table>", "</title><script>a</script>",
    "\"><svg onload=alert(1)>", "' onmouseover='alert(1)", "<!-- open", "--> closed",
    "<![CDATA[x]]>",
    "<iframe src=javascript:alert(1)>", "<a href=javascript:a>b</a>", "<style>*{color:red}</style>",
    "&lt;b&gt;", "&#x3c;script&#x3e;", "&nbsp;", "<base href=//x>", "<meta http-equiv=refresh>",
    "</style>", "</script>", "<?php echo 1 ?>", "{{ 7 * 7 }}", "{% include 'x' %}", "${7*7}",
)  # fmt: skip
MARKDOWN = (
    "![i](http://a.b/c.png)", "[x]: http://a.b", "http://a.b/c", "https://a.b?c=d", "www.a.b",
    "@everyone look", "a@b.c", "> quoted", "## Two", "* point", "+ point", "---", "===", "***",
    "1) first", "__bold__", "~~gone~~", "<details open>", "| a | b |", "\\| a", "[^1]", ":smile:",
    "- [ ] todo", "a\\", "**", "``",
)  # fmt: skip
FORMULAS = ("=cmd()", "=1+1", "+1", "-2", "@SUM(A1)", '=HYPERLINK("a","b")', 'a",=1+1,"')
PLACES = ("../../x", "%s %n {0} {x!r}", '"""; import os', "'); DROP TABLE x")
ODD = ("שלום", "a\ufffeb", "e\u0301", "中" * 100, "❤\ufe0f", "a%2Fb", "∕")
UNSEEN = ("\u200fright", "left\u200e", "a\u202eb", "\u2066a\u2069", "a\u061cb", "zero\u200bwide")
CONTROLS = (
    "\x1b[2J", "\x1b]0;title\x07", "a\x00b", "a\rb", "a\n::error::b", "\x9b31m", "a\u2028b",
    "a\ud800", "\ufeffa", "a\x7f", "\u2067\U000e0001",
)  # fmt: skip
LONG = 10_000 * "x"
"""These, and what nobody sees, no name may hold; a title may."""

IN_CELLS = MARKUP + TYPST + HTML + MARKDOWN + FORMULAS + PLACES + ODD
HOSTILE = (*IN_CELLS, *UNSEEN, *CONTROLS, LONG)
