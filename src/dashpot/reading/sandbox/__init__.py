"""Foreign parsers in a process of their own: what they break is not ours."""
