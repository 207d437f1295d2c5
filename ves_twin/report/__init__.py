"""report: parts of a self-contained HTML page: text, tables, figures."""
