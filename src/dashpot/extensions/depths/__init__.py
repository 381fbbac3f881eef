"""One law of stiffness over depth from tests at several compressions."""
