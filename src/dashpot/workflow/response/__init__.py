"""From a fit to the response of a mass on it: at rest, pressed, at a level."""
