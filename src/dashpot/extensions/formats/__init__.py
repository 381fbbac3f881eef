"""Binary formats of measurement systems, each parsed in a child process with limits."""
