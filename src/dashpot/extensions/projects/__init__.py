"""What is kept of a study: documents, a project and its history, and the proof of both."""
