"""Extensions beyond the paper's method, which the core finds by its registry alone."""
