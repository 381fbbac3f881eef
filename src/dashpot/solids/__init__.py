"""What a viscoelastic part is."""
