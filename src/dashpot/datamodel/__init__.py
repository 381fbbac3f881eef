"""Values that packages exchange: tests as measured, and the fit."""
