"""Planning of tests: what they can determine, before they are run."""
