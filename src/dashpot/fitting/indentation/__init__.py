"""A contact's motion to the law of the surface."""
