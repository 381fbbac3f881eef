"""Planning of tests: the quantities they can determine, before they are run."""
