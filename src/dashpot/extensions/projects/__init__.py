"""Projects: kept documents, their history, and the verification of both."""
