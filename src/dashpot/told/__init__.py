"""What people are told of each result, as text: the same in a terminal and in Python."""
