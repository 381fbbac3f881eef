"""Sandbox: third-party parsers in a child process with limits."""
