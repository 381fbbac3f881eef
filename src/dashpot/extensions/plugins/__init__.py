"""File formats, kinds of tests and solver inputs of plug-ins: plain data in and out, validated."""
