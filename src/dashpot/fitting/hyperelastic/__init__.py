"""From stress over stretch in one mode or several to a hyperelastic law."""
