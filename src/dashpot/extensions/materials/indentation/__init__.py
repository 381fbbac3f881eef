"""A ball or a block that hits a part: the law of its contact."""
