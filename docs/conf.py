"""Sphinx configuration. Build with ``make docs``."""

from __future__ import annotations

import sys
from pathlib import Path

import rotatum

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE / "_ext")]

project = "rotatum"
author = "The rotatum authors"
copyright = "2026, The rotatum authors"
release = version = rotatum.__version__

extensions = [
    "apipages",
    "commands",
    "docstrings",
    "laws",
    "mathml",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "symbols",
]
exclude_patterns = ["_build", "_ext"]
html_math_renderer = "mathml"
html_theme = "furo"
html_title = "rotatum"
html_show_sourcelink = False

myst_enable_extensions = ["amsmath", "deflist", "dollarmath"]
myst_heading_anchors = 3

# A bare type name in a signature may be two modules' own; which one it links to is no defect.
suppress_warnings = ["ref.python"]

# A name between single backticks in a docstring is code.
default_role = "code"
autodoc_typehints = "signature"
autodoc_default_options = {"exclude-members": "model_config"}
napoleon_google_docstring = True
napoleon_numpy_docstring = True
napoleon_use_rtype = False
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
