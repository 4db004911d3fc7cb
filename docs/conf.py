"""How Sphinx builds these pages: ``make docs``."""

from importlib import metadata

project = "bayesfric"
author = "The bayesfric authors"
copyright = author
release = metadata.version("bayesfric")
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx.ext.napoleon"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
exclude_patterns = ["_build", "_examples", "schemas"]
html_theme = "alabaster"
html_theme_options = {
    "description": "Bayesian uncertainty analysis of cable-pulley friction",
    "fixed_sidebar": True,
    "page_width": "70rem",
}
html_show_sourcelink = False
autodoc_typehints = "signature"
autodoc_member_order = "bysource"
nitpicky = False
