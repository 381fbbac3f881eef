"""Blank tests of a testing machine: a rigid stop, a steel spring, an empty run."""
