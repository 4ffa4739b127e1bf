"""Sphinx for the site of mjdiag; scripts/docs runs it."""

project = "mjdiag"
copyright = "the authors of mjdiag, Apache-2.0"
extensions = ["myst_parser", "sphinx.ext.mathjax"]
myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 4
smartquotes = False  # --records is two signs
html_theme = "furo"
html_title = "mjdiag"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_search_summary = False  # a page opened as a file may not read another one
# From this site itself: it is read without a network.
mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_CHTML"
myst_update_mathjax = False
mathjax2_config = {"tex2jax": {"inlineMath": [["\\(", "\\)"]], "displayMath": [["\\[", "\\]"]]},
                   "messageStyle": "none", "showMathMenu": False}
add_module_names = False


def setup(app):
    """The tree at the side is the same for all sources, which are not in it: made for each of
    them it takes most of the time."""
    from sphinx.builders.html import StandaloneHTMLBuilder
    made, make = {}, StandaloneHTMLBuilder._get_local_toctree

    def once(builder, page, collapse=True, **options):
        if not page.startswith("source/"):
            return make(builder, page, collapse, **options)
        key = (collapse, *sorted(options.items()))
        if key not in made:
            made[key] = make(builder, page, collapse, **options)
        return made[key]

    StandaloneHTMLBuilder._get_local_toctree = once
    return {"parallel_read_safe": True, "parallel_write_safe": True}
