"""The report: stored results become one content tree, shown as PDF and HTML, page one as Markdown.

- `bayesfric.report.content`: the tree (headings, paragraphs, tables, figures);
- `bayesfric.report.quantities`: numbers and units as text;
- `bayesfric.report.typst`: `render_pdf`;
- `bayesfric.report.html`: `render_html`;
- `bayesfric.report.markdown`: `render_summary`, of page one.

A renderer is imported from its own module, so that the tree stays cheap to import.
"""

from bayesfric.report.content import Document

__all__ = ["Document"]
