"""One cause or two that explain a record, their rivals, recordings that disagree."""
