"""The hammer half: from impacts to frequency response functions, measured and predicted."""
